"""Compares simulations of an exported module with those of the program: signal and largest difference over largest value."""

import json
import pathlib
import sys

import numpy as np

folder = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(folder))
from test_cell_4 import Bench, EngineSpeedControl, Start  # noqa: E402

KEYS = {"Speed": "speed_demand", "Torque": "torque_demand", "AirGap": "air_gap_torque", "Governed": "torque_demand"}

for case in json.loads((folder / "cases.json").read_text()):
    bench, start = Bench(), Start(*case["start"])
    options = {KEYS[case["drive"]]: case["demand"], "sample_time": 1e-3}
    if case["drive"] == "Governed":
        options["engine_speed_control"] = EngineSpeedControl(np.array(case["governed_speed"]), 2.0, 3.0, 1.5)
    response = bench.simulate(case["engine"], start, **options)
    for name, expected in case["expected"].items():
        expected = np.array(expected)
        if len(expected):
            difference = np.abs(response[name] - expected).max() / np.abs(expected).max()
            print(case["drive"], name, difference)

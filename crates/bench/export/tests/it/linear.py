"""Compares the simulation of an exported linear model with that of the program."""

import json
import pathlib
import sys

import numpy as np

folder = pathlib.Path(sys.argv[1])
sys.path.insert(0, str(folder))
import arx  # noqa: E402

expected = json.loads((folder / "expected.json").read_text())
y = arx.simulate(np.array(expected["u"]))
print("y", np.abs(y - np.array(expected["y"])).max() / np.abs(expected["y"]).max())
assert arx.INPUTS == [("T_demand", "Nm")] and arx.OUTPUTS == [("N_dyno \"1\"", "rpm")]

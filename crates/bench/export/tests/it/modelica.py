"""Simulates exported Modelica models with rumoca and compares them, sample by sample, with the program."""

import json
import pathlib
import sys

import numpy as np
import rumoca

folder = pathlib.Path(sys.argv[1])
for file in folder.glob("*.mo"):
    assert not [d for d in rumoca.validate(str(file)) if d.severity == "error"], rumoca.validate(str(file))
for name, signals in json.loads((folder / "expected.json").read_text()).items():
    model = rumoca.Session().load(str(folder / "driven" / "driven.mo"), model=name)
    count = len(next(iter(signals.values())))
    config = rumoca.SimConfig(rtol=1e-6, atol=1e-7)
    result = model.simulate((count - 1) * 1e-3, dt=1e-3, config=config)
    time = np.asarray(result.time)
    # At an event there are two rows: before and after it. Of a bench the program has what is there before, of a discrete
    # linear model what is there after.
    instants = np.arange(count) * 1e-3
    after = np.searchsorted(time, instants + 1e-9) - 1
    at = after if name == "Driven" else np.searchsorted(time, instants - 1e-9)
    for signal, expected in signals.items():
        expected = np.array(expected)
        found = np.asarray(result[signal])[at]
        print(name, signal, np.abs(found - expected).max() / np.abs(expected).max())

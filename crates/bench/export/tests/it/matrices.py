"""Simulates the discrete systems of a MAT-file and compares them with the program."""

import pathlib
import sys

import numpy as np
from scipy.io import loadmat

folder = pathlib.Path(sys.argv[1])
bench = loadmat(folder / "test_cell_4.mat", simplify_cells=True)["bench"]
assert bench["name"] == "Test cell 4" and bench["parameters"]["K"] == 2437.7 and bench["units"]["K"] == "Nm/rad"
assert bench["covariance"][0]["names"].tolist() == ["K", "B"] and bench["covariance"][0]["matrix"][0, 1] == 0.3
assert bench["valid"]["w_d"].tolist() == [80.0, 260.0]
assert bench["plant"]["InputDelay"][0] == 1.25e-3 and bench["plant"]["A"].shape == (4, 4)
for mode in ("nt", "tn"):
    system = bench[mode]
    a, b, c, d = (system[name] for name in "ABCD")
    assert system["Ts"] == 1e-3 and len(system["StateName"]) == len(a) and len(system["OutputName"]) == len(c)
    u = np.loadtxt(folder / f"{mode}_u.csv", delimiter=",")
    expected = np.loadtxt(folder / f"{mode}_y.csv", delimiter=",")
    x, y = np.zeros(len(a)), np.empty_like(expected)
    for k, row in enumerate(u):
        y[k] = c @ x + d @ row
        x = a @ x + b @ row
    for i, name in enumerate(system["OutputName"]):
        print(mode, name, np.abs(y[:, i] - expected[:, i]).max() / np.abs(expected[:, i]).max())

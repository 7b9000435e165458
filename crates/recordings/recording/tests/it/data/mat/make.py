"""Small MAT-files for the tests of `recording`, from made-up numbers: scipy writes them, but for the big-endian ones."""
import struct, sys
import numpy as np
import scipy.io as sio
import scipy.sparse as sp

out = sys.argv[1]
n = 6
t = np.arange(n) / 100.0
col = lambda x: np.asarray(x, dtype=float).reshape(-1, 1)
signal = np.zeros((1, 2), dtype=[("values", object), ("dimensions", object), ("label", object), ("blockName", object)])
signal[0, 0] = (col(np.arange(n) * 2.0), 1.0, "speed", "plant/Speed")
signal[0, 1] = (np.column_stack([np.arange(n) + 10.0, np.arange(n) + 20.0]), 2.0, "", "plant/Mux")
content = {
    "t": col(t),
    "torque": col(np.arange(n) + 0.5),
    "torque_unit": "Nm",
    "counts": np.arange(n, dtype=np.int16).reshape(1, -1) - 3,
    "single": np.arange(n, dtype=np.float32).reshape(-1, 1) / 4,
    "on": np.array([[True], [False], [True], [True], [False], [True]]),
    "big": (np.arange(n, dtype=np.uint64) + 2**40).reshape(-1, 1),
    "wide": np.arange(2 * n, dtype=float).reshape(2, n),
    "tall": np.arange(2 * n, dtype=float).reshape(n, 2),
    "cube": np.zeros((2, 3, n)),
    "deep": np.arange(n, dtype=float).reshape(1, 1, n),
    "gain": 7.25,
    "nothing": np.zeros((0, 0)),
    "text": "hello",
    "z": np.full((n, 1), 1 + 2j),
    "sparse": sp.csc_matrix(np.eye(3)),
    "alone": col([1, 2, 3]),
    "cells": np.array([[col(np.arange(n) + 100.0), "x", col([1, 2])]], dtype=object),
    "run": {"time": col([0, 1, 2]), "sub": {"y": col([5, 6, 7])}, "unit": "rpm"},
    "sim": {"time": col(t), "signals": signal, "blockName": "model"},
    "data": {"Ts": 0.5, "TimeUnit": "milliseconds", "u": col([1, 2, 3, 4]), "y": np.arange(8.0).reshape(4, 2),
             "InputName": "voltage", "OutputName": np.array([["position"], ["speed"]], dtype=object),
             "OutputUnit": np.array([["rad"], ["rad/s"]], dtype=object)},
}
sio.savemat(f"{out}/variables.mat", content)
sio.savemat(f"{out}/variables_deflated.mat", content, do_compression=True)
sio.savemat(f"{out}/level4.mat", {"t": col(t), "y": np.arange(2 * n, dtype=float).reshape(n, 2), "text": "hello",
            "k": np.arange(n, dtype=np.int16).reshape(-1, 1), "z": np.full((n, 1), 1j)}, format="4")

def element(kind, data):
    return struct.pack(">II", kind, len(data)) + data + b"\0" * (-len(data) % 8)

def matrix(name, kind, fmt, cls, values):
    data = b"".join(struct.pack(fmt, v) for v in values)
    body = element(6, struct.pack(">II", cls, 0)) + element(5, struct.pack(">ii", len(values), 1))
    return element(14, body + element(1, name) + element(kind, data))

head = b"MATLAB 5.0 MAT-file, big-endian".ljust(116) + b"\0" * 8 + b"\x01\x00MI"
with open(f"{out}/big_endian.mat", "wb") as f:
    f.write(head + matrix(b"time", 9, ">d", 6, t) + matrix(b"y", 3, ">h", 10, [-1, 2, -300, 4, 5, 6]))
with open(f"{out}/big_endian4.mat", "wb") as f:
    for name, p, fmt, values in [(b"time\0", 0, ">d", t), (b"y\0", 3, ">h", [-1, 2, -300, 4, 5, 6])]:
        f.write(struct.pack(">5i", 1000 + 10 * p, n, 1, 0, len(name)) + name)
        f.write(b"".join(struct.pack(fmt, v) for v in values))

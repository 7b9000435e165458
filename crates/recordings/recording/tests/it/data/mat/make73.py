"""A small MAT-file of level 7.3 from made-up numbers, as MATLAB writes them, and a plain HDF5 file, by h5py."""
import sys
import h5py
import numpy as np

out = sys.argv[1]
n = 6
ref = h5py.ref_dtype


def put(group, name, array, kind, **attributes):
    """An array as MATLAB stores it: transposed."""
    data = np.ascontiguousarray(np.asarray(array).T)
    extra = dict(chunks=data.shape, compression="gzip", shuffle=True) if data.size > 10 else {}
    dataset = group.create_dataset(name, data=data, track_times=False, **extra)
    dataset.attrs["MATLAB_class"] = np.bytes_(kind)
    for key, value in attributes.items():
        dataset.attrs[key] = value
    return dataset


def text(group, name, words):
    codes = np.array([[ord(c) for c in words]], dtype=np.uint16)
    return put(group, name, codes, "char", MATLAB_int_decode=np.int32(2))


def struct(group, name):
    inner = group.create_group(name)
    inner.attrs["MATLAB_class"] = np.bytes_("struct")
    return inner


def refer(group, name, targets):
    return group.create_dataset(name, data=np.array([[t.ref] for t in targets], dtype=ref), dtype=ref, track_times=False)


col = lambda x: np.asarray(x, dtype=float).reshape(-1, 1)
with h5py.File(f"{out}/variables73.mat", "w", userblock_size=512) as f:
    refs = f.create_group("#refs#")
    put(f, "t", col(np.arange(n) / 100.0), "double")
    put(f, "torque", col(np.arange(n) + 0.5), "double")
    text(f, "torque_unit", "Nm")
    put(f, "counts", np.arange(n, dtype=np.int16).reshape(1, -1) - 3, "int16")
    put(f, "on", np.array([[1], [0], [1], [1], [0], [1]], dtype=np.uint8), "logical", MATLAB_int_decode=np.int32(1))
    put(f, "tall", np.arange(2 * n, dtype=float).reshape(n, 2), "double")
    put(f, "cube", np.zeros((2, 3, n)), "double")
    put(f, "gain", [[7.25]], "double")
    put(f, "nothing", np.array([0, 0], dtype=np.uint64), "double", MATLAB_empty=np.uint8(1))
    put(f, "z", np.array([[(1.0, 2.0)]] * n, dtype=[("real", "f8"), ("imag", "f8")]), "double")
    put(f, "table", np.array([[0xDD000000, 2, 1, 1, 1, 1]], dtype=np.uint32), "table", MATLAB_object_decode=np.int32(3))
    cells = [put(refs, "a", col(np.arange(n) + 100.0), "double"), text(refs, "b", "hello")]
    refer(f, "cells", cells).attrs["MATLAB_class"] = np.bytes_("cell")
    run = struct(f, "run")
    put(run, "Time", col([0.0, 1.0, 2.0]), "double")
    put(struct(run, "sub"), "y", col([5.0, 6.0, 7.0]), "double")
    data = struct(f, "data")
    put(data, "Ts", [[0.5]], "double")
    text(data, "TimeUnit", "milliseconds")
    put(data, "y", col([1.0, 3.0, 5.0, 7.0]), "double")
    name = text(refs, "c", "speed")
    refer(data, "OutputName", [name]).attrs["MATLAB_class"] = np.bytes_("cell")
    many = struct(f, "many")
    refer(many, "v", [put(refs, "d", col(np.arange(n)), "double"), put(refs, "e", col(np.arange(n) * 2.0), "double")])

with h5py.File(f"{out}/small73.mat", "w", userblock_size=512) as f:
    put(f, "t", col(np.arange(12) / 100.0), "double")
    run = struct(f, "run")
    put(run, "y", col(np.arange(12) + 0.5), "double")

header = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Sat Nov 21 12:00:00 2026 HDF5 schema 1.00 ."
for name in ["variables73.mat", "small73.mat"]:
    file = open(f"{out}/{name}", "r+b")
    file.write(header.ljust(116, b" ") + bytes(8) + bytes([0, 2]) + b"IM")
    file.close()

with h5py.File(f"{out}/plain.h5", "w", libver="latest") as f:
    f.create_dataset("time", data=np.arange(n) / 10.0, track_times=False)
    speed = f.create_dataset("speed", data=np.arange(n, dtype=np.float32) * 2, track_times=False)
    speed.attrs["unit"] = "rpm"
    f.create_dataset("table", data=np.arange(2 * n).reshape(n, 2), track_times=False)

# The layout of chunks in HDF5 1.10, and in 2.0.
for name, libver in (("small", ("earliest", "v110")), ("newer", "latest")):
    with h5py.File(f"{out}/{name}.h5", "w", libver=libver) as f:
        f.create_dataset("time", data=np.arange(n) / 10.0, track_times=False)
        f.create_dataset("speed", data=np.arange(n) * 2, track_times=False, chunks=(4,), compression="gzip", fletcher32=True)

with h5py.File(f"{out}/clock_unit.h5", "w", libver=("earliest", "v108")) as f:
    f.create_dataset("time", data=np.arange(n) * 10.0, track_times=False).attrs["Unit"] = "ms"
    f.create_dataset("speed", data=np.arange(n) * 2, track_times=False)
    f.create_dataset("on", data=np.arange(n) % 2 == 1, track_times=False)
    f.create_dataset("half", data=np.arange(n, dtype=np.float16) / 2 - 1, track_times=False)

# A link that is no dataset, in the layout of groups before HDF5 1.8.
with h5py.File(f"{out}/soft_link.h5", "w", libver=("earliest", "v108")) as f:
    f.create_dataset("time", data=np.arange(n) / 10.0, track_times=False)
    f.create_dataset("speed", data=np.arange(n) * 2, track_times=False)
    f["revolutions"] = h5py.SoftLink("/speed")

"""Writes small files of every format for the fuzzer to start from, and copies those it finds in folders of recordings.

    target/python/bin/python fuzz/seeds.py fuzz/corpus [FOLDER ...]

`cargo xtask check` installs the packages that this needs into target/python.
"""

import pathlib
import shutil
import sys

import h5py
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.feather
import pyarrow.parquet
import scipy.io
from asammdf import MDF, Signal

# Larger files cost the fuzzer more than they tell it.
LARGEST = 64 * 1024
TARGETS = {
    "csv": [".csv", ".tsv", ".txt"],
    "mat": [".mat"],
    "mat73": [".mat", ".h5"],
    "mdf": [".mf4", ".mdf", ".dat", ".mf3"],
    "parquet": [".parquet"],
    "arrow": [".arrow", ".feather"],
}
TIME = np.arange(40) * 0.01
SPEED = np.sin(TIME)


def frame():
    columns = {"time": TIME, "speed": SPEED, "count": np.arange(40, dtype=np.int16), "torque": SPEED.astype(np.float32)}
    return pd.DataFrame({**columns, "text": [f"row {n}" for n in range(40)], "flag": np.arange(40) % 3 == 0})


def csv(folder):
    table = frame()
    table.to_csv(folder / "plain.csv", index=False)
    table.to_csv(folder / "german.csv", index=False, sep=";", decimal=",", encoding="utf-8-sig")
    table.to_csv(folder / "tabs.csv", index=False, sep="\t")
    stamped = table.assign(time=pd.Timestamp("2024-02-29 12:00:00") + pd.to_timedelta(TIME, unit="s"))
    stamped.to_csv(folder / "stamps.csv", index=False)
    (folder / "units.csv").write_text("# a comment\ntime;N [rpm];T\ns;1/min;Nm\n0,0;1,5;\n0,1;NaN;3e2\n")
    (folder / "two-clocks.csv").write_text('"time","a","time","b"\n0,1,0,5\n0.1,2,0.5,6\n0.2,3,,\n')
    (folder / "wide.csv").write_text("time\r\n0 1 2\r\n1 2 3\r\n", encoding="utf-16")


def mat(folder):
    content = {
        "time": TIME,
        "speed": SPEED,
        "run": {"t": TIME, "torque": SPEED.astype(np.float32), "name": "a", "inner": {"x": np.eye(3)}},
        "cells": np.array([TIME, "text"], dtype=object),
        "many": np.array([(1, SPEED), (2, TIME)], dtype=[("n", object), ("v", object)]),
        "counts": np.arange(40, dtype=np.int16),
        "flags": TIME > 0.2,
        "complex": SPEED + 1j,
    }
    scipy.io.savemat(folder / "level5.mat", content)
    scipy.io.savemat(folder / "level7.mat", content, do_compression=True, long_field_names=True)
    scipy.io.savemat(folder / "level4.mat", {"time": TIME, "speed": SPEED}, format="4")


def mat73(folder):
    for version, options in [("earliest", {}), ("latest", {"chunks": (10,), "compression": "gzip", "shuffle": True})]:
        with h5py.File(folder / f"{version}.mat", "w", libver=version, userblock_size=512) as file:
            file.create_dataset("time", data=TIME, **options)
            group = file.create_group("run")
            speed = group.create_dataset("speed", data=SPEED, fletcher32=True, maxshape=(None,), chunks=(10,))
            speed.attrs["MATLAB_class"] = np.bytes_("double")
            group["count"] = np.arange(40, dtype=">i2")
            group["name"] = "text"
            file["pairs"] = np.array([(1, 2.0)] * 5, dtype=[("a", "i4"), ("b", "f8")])


def mdf(folder):
    signals = [
        Signal(SPEED, TIME, name="speed", unit="rpm"),
        Signal(np.arange(40, dtype=np.uint16), TIME, name="count", conversion={"a": 0.5, "b": 1.0}),
        Signal(SPEED.astype(np.float32), TIME, name="torque"),
        Signal(np.array([b"on", b"off"] * 20), TIME, name="state", encoding="utf-8"),
    ]
    # Of version 4 alone.
    array = Signal(np.arange(120, dtype=np.int8).reshape(40, 3), TIME, name="array")
    for version in ["2.14", "3.30", "4.00", "4.10", "4.11", "4.20"]:
        for compression in [0, 1, 2] if version.startswith("4") else [0]:
            with MDF(version=version) as file:
                file.append(signals + [array] * version.startswith("4"), common_timebase=True)
                file.append([Signal(SPEED[::4], TIME[::4], name="slow")])
                file.save(folder / f"{version}-{compression}.mdf", overwrite=True, compression=compression)


def parquet(folder):
    for compression in ["none", "snappy", "gzip", "zstd", "lz4", "brotli"]:
        frame().to_parquet(folder / f"{compression}.parquet", compression=compression)
    stamped = frame().assign(time=pd.Timestamp("2024-02-29") + pd.to_timedelta(TIME, unit="s"))
    pa.parquet.write_table(pa.Table.from_pandas(stamped), folder / "v2.parquet", data_page_version="2.0", row_group_size=16)


def arrow(folder):
    for compression in ["uncompressed", "lz4", "zstd"]:
        frame().to_feather(folder / f"{compression}.arrow", compression=compression)
    with pa.ipc.new_stream(folder / "stream.arrow", pa.Table.from_pandas(frame()).schema) as stream:
        stream.write_table(pa.Table.from_pandas(frame()), max_chunksize=16)


def main():
    corpus, *folders = [pathlib.Path(argument) for argument in sys.argv[1:]]
    for target, endings in TARGETS.items():
        folder = corpus / target
        folder.mkdir(parents=True, exist_ok=True)
        globals()[target](folder)
        for found in (path for given in folders for path in sorted(given.rglob("*"))):
            if found.suffix.lower() in endings and found.is_file() and found.stat().st_size <= LARGEST:
                shutil.copyfile(found, folder / f"{found.parent.name}-{found.name}")
        print(f"{target}: {len(list(folder.iterdir()))} files")


main()

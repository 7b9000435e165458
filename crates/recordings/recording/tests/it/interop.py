"""The files of `recording` and those of scipy, pandas, pyarrow and h5py, each read by the other side.

`interop.py read FOLDER` prints what these packages read in the files written.csv, .mat, .parquet and .arrow of the folder;
`interop.py write FOLDER` writes files and prints what is in them.
A line: file, channel, unit, samples, FNV-1a of the time stamps and of the samples as little-endian doubles."""
import decimal
import struct
import sys

import h5py
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.feather as feather
import pyarrow.ipc as ipc
import pyarrow.parquet as pq
import scipy.io as sio


def fnv(values):
    h = 0xCBF29CE484222325
    data = [float("nan") if v is None or v != v else float(v) for v in values]
    for b in struct.pack(f"<{len(data)}d", *data):
        h = ((h ^ b) * 0x100000001B3) & (2**64 - 1)
    return f"{h:016x}"


def line(file, name, unit, time, values):
    print("\t".join([file, name, unit, str(len(values)), fnv(time), fnv(values)]))


def table(file, read):
    """A table of ours: nulls are rows of other rasters."""
    time = read.column("time").to_pylist()
    for field in read.schema:
        if field.name == "time":
            continue
        meta = {k.decode(): v.decode() for k, v in (field.metadata or {}).items()}
        rows = [(t, v) for t, v in zip(time, read.column(field.name).to_pylist()) if v is not None]
        line(file, meta["name"], meta["unit"], [t for t, _ in rows], [v for _, v in rows])


def read(folder):
    frame = pd.read_csv(f"{folder}/written.csv", float_precision="round_trip")
    time = None
    for name in frame.columns:
        if name.startswith("time [s]"):
            time = frame[name].dropna()
            continue
        head, _, unit = name.partition(" [")
        line("written.csv", head, unit.rstrip("]"), time, frame[name][: len(time)])
    mat = sio.loadmat(f"{folder}/written.mat", simplify_cells=True)
    for channel in np.atleast_1d(mat["recording_info"]["channels"]):
        time, samples = (np.atleast_1d(mat[channel[key]]) for key in ("time", "variable"))
        line("written.mat", channel["name"], channel["unit"] if len(channel["unit"]) else "", time, samples)
    table("written.parquet", pq.read_table(f"{folder}/written.parquet"))
    table("written.arrow", feather.read_table(f"{folder}/written.arrow"))
    # As a user does it.
    frame = pd.read_parquet(f"{folder}/written.parquet")
    assert list(frame.columns)[0] == "time" and frame["time"].is_monotonic_increasing


def write(folder):
    rng = np.random.default_rng(1)
    n = 40
    time = np.arange(n) / 100
    speed, torque = rng.normal(size=n), rng.normal(size=n) * 1e3
    torque[3] = np.nan
    frame = pd.DataFrame({"time": time, "speed [rpm]": speed, "torque [Nm]": torque, "on": speed > 0, "state": "ok"})
    values = [("speed", "rpm", speed), ("torque", "Nm", torque), ("on", "", (speed > 0) * 1.0)]

    def expect(file, stamps=time):
        for name, unit, samples in values:
            line(file, name, unit, stamps, samples)

    frame.to_parquet(f"{folder}/pandas.parquet", index=False)
    expect("pandas.parquet")
    frame.to_parquet(f"{folder}/gzip.parquet", index=False, compression="gzip", row_group_size=7)
    expect("gzip.parquet")
    stamps = pd.date_range("2026-11-21 12:00", periods=n, freq="10ms", tz="Europe/Berlin")
    dated = frame.drop(columns="time").set_index(stamps)
    dated.to_parquet(f"{folder}/index.parquet")
    expect("index.parquet")
    dated.tz_convert(None).to_csv(f"{folder}/index.csv", index_label="time")
    expect("index.csv")
    frame.to_csv(f"{folder}/pandas.csv", index=False)
    expect("pandas.csv")
    frame.to_csv(f"{folder}/german.csv", index=False, sep=";", decimal=",", na_rep="n/a", encoding="utf-16")
    expect("german.csv")
    np.savetxt(f"{folder}/numpy.csv", np.column_stack([time, speed]), delimiter=",", header="time [s],speed [rpm]", fmt="%.17g")
    line("numpy.csv", "speed", "rpm", time, speed)
    for compression in ["lz4", "zstd", "uncompressed"]:
        feather.write_feather(frame, f"{folder}/{compression}.feather", compression=compression, chunksize=9)
        expect(f"{compression}.feather")
    cents = [int(round(v * 100)) for v in speed]
    arrays = {
        "time": pa.array((time * 1000).round().astype("int64"), pa.duration("ms")),
        "decimal": pa.array([decimal.Decimal(c).scaleb(-2) for c in cents], pa.decimal128(23, 2)),
        "dictionary": pa.array(np.arange(n) % 3 * 1.5).dictionary_encode(),
        "half": pa.array(speed.astype(np.float16)),
        "unsigned": pa.array(np.arange(n, dtype=np.uint8)),
    }
    with ipc.new_stream(f"{folder}/types.arrows", pa.table(arrays).schema) as stream:
        stream.write_table(pa.table(arrays), max_chunksize=11)
    columns = [
        ("decimal", np.array(cents) / 100),
        ("dictionary", np.arange(n) % 3 * 1.5),
        ("half", speed.astype(np.float16).astype(float)),
        ("unsigned", np.arange(n, dtype=float)),
    ]
    for name, samples in columns:
        line("types.arrows", name, "", (time * 1000).round() / 1000, samples)
    pq.write_table(pa.table(arrays), f"{folder}/types.parquet", version="2.6", data_page_version="2.0")
    for name, samples in columns:
        line("types.parquet", name, "", (time * 1000).round() / 1000, samples)
    run = {"time": time, "speed": speed, "speed_unit": "rpm", "sub": {"torque": torque.reshape(-1, 1)}}
    sio.savemat(f"{folder}/scipy.mat", {"run": run}, do_compression=True)
    line("scipy.mat", "run.speed", "rpm", time, speed)
    line("scipy.mat", "run.sub.torque", "", time, torque)
    with h5py.File(f"{folder}/h5py.h5", "w") as f:
        group = f.create_group("run")
        group["time"] = time
        group.create_dataset("speed", data=speed, chunks=(7,), compression="gzip", shuffle=True, fletcher32=True)
        group["speed"].attrs["unit"] = "rpm"
        group.create_dataset("lzf", data=torque.astype("f4"), chunks=(16,), compression="lzf")
    line("h5py.h5", "run.lzf", "", time, torque.astype("f4").astype(float))
    line("h5py.h5", "run.speed", "rpm", time, speed)


{"read": read, "write": write}[sys.argv[1]](sys.argv[2])

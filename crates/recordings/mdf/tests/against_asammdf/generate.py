"""Writes a grid of MDF files with asammdf: versions, data types, conversions, compression, arrays, invalidation bits, clocks.

    generate.py OUT
"""

import itertools
import logging
import sys
import warnings
from pathlib import Path

import numpy as np
from asammdf import MDF, Signal
from asammdf.blocks import v4_constants as v4c
from asammdf.blocks.conversion_utils import from_dict

warnings.filterwarnings("ignore")
logging.disable(logging.CRITICAL)

TYPES = ["u1", "<u2", "<u4", "<u8", "i1", "<i2", "<i4", "<i8", "<f4", "<f8", ">u2", ">i4", ">f4", ">f8", ">i2", ">u4"]
# Of MDF 4 only.
MORE_TYPES = ["<f2", ">f2", ">u8", ">i8"]
CONVERSIONS = {
    "linear": {"a": 0.1, "b": -3.7},
    "rational": {"P1": 0.0, "P2": 2.0, "P3": 1.0, "P4": 0.0, "P5": 0.01, "P6": 4.0},
    "rational_full": {"P1": 0.3, "P2": 2.0, "P3": 1.0, "P4": 0.1, "P5": 0.01, "P6": 4.0},
    "formula": {"formula": "2.5 * X ** 2 - 3 * (X + 1) / 7 + sin(X)"},
    "interpolated": {"interpolation": True, **{f"raw_{i}": 10 * i for i in range(6)}, **{f"phys_{i}": i * i for i in range(6)}},
    "table": {"interpolation": False, **{f"raw_{i}": 10 * i for i in range(6)}, **{f"phys_{i}": i * i for i in range(6)}},
    "ranges": {"lower_0": 0, "upper_0": 9, "phys_0": 1, "lower_1": 10, "upper_1": 29, "phys_1": 2, "default": -1},
    "texts": {"val_0": 1, "text_0": "one", "val_1": 7, "text_1": "seven", "val_2": 20, "text_2": "twenty", "default": b"none"},
    "range_texts": {"lower_0": 0, "upper_0": 9, "text_0": "low", "lower_1": 10, "upper_1": 29, "text_1": "high", "default": b"none"},
}


def samples(kind, n, seed):
    rng = np.random.default_rng(seed)
    kind = np.dtype(kind)
    if kind.kind == "f":
        return (rng.standard_normal(n) * 20).astype(kind)
    info = np.iinfo(kind)
    values = rng.integers(0, 60, n)
    values[:2] = [max(info.min, -(2**52)), min(info.max, 2**52)]
    return values.astype(kind)


def numbers(t, types=TYPES):
    return [Signal(samples(k, len(t), i), t, unit="Nm", name=f"n_{k.strip('<>')}_{i}") for i, k in enumerate(types)]


def converted(t, old):
    for i, (name, conversion) in enumerate(CONVERSIONS.items()):
        if old and name in ("ranges",):
            continue
        for kind in ("u1", "<i2", "<f8"):
            if kind == "<f8" and "texts" in name:
                continue
            values = samples(kind, len(t), 100 + i)
            if kind != "<f8":
                values[:2] = [3, 5]
            yield Signal(values, t, unit="V", name=f"{name}_{np.dtype(kind).name}", conversion=from_dict(dict(conversion)))


def nested(t):
    """Conversions within conversions, and of bits to text."""
    linear, raw = {"a": 2.0, "b": 0.5}, samples("u1", len(t), 7)
    states = {"val_0": 3, "text_0": "three", "val_1": 5, "text_1": "five", "default_addr": linear}
    ranges = {"lower_0": 0, "upper_0": 9, "text_0": dict(linear), "lower_1": 10, "upper_1": 29, "text_1": "high"}
    ranges["default_addr"] = {"formula": "X ** 2"}
    bits = {"mask_0": 1, "text_0": {"val_0": 0, "text_0": "off", "val_1": 1, "text_1": "on"}}
    bits |= {"mask_1": 6, "text_1": {"val_0": 2, "text_0": "two", "val_1": 4, "text_1": "four"}}
    numbers_only = {"lower_0": 0, "upper_0": 9, "text_0": dict(linear), "default_addr": {"a": -1.0, "b": 0.0}}
    for name, conversion in (("states", states), ("ranges", ranges), ("bits", bits), ("numbers", numbers_only)):
        yield Signal(raw, t, name=f"nested_{name}", conversion=from_dict(conversion))


def clocks(file, n):
    """Groups over an angle, a distance and indices; a master and a channel that are not in the records."""
    for name, sync in (("angle", v4c.SYNC_TYPE_ANGLE), ("distance", v4c.SYNC_TYPE_DISTANCE), ("index", v4c.SYNC_TYPE_INDEX)):
        file.append([Signal(np.arange(n) ** 2.0, np.arange(n) * 3.0, name=f"over_{name}", master_metadata=(name, sync))])
    t = np.arange(n) * 0.25 + 3
    recorded = Signal(np.arange(float(n)), t, name="recorded", flags=Signal.Flags.virtual_master)
    computed = Signal(np.arange(n) * 2.0 + 1, t, name="computed", flags=Signal.Flags.virtual_master | Signal.Flags.virtual)
    computed.virtual_conversion = from_dict({"a": 2.0, "b": 1.0})
    for signal in (recorded, computed):
        signal.virtual_master_conversion = from_dict({"a": 0.25, "b": 3.0})
    file.append([recorded, computed], common_timebase=True, comment="virtual master")


def texts(t):
    words = np.array([f"wort {i % 17} äöü" for i in range(len(t))])
    for encoding in ("utf-8", "latin-1", "utf-16-le"):
        data = np.array([w.encode(encoding) for w in words])
        yield Signal(data, t, name=f"text_{encoding}", encoding=encoding)


def arrays(t):
    n = len(t)
    values = np.arange(n * 6, dtype="<f4").reshape(n, 2, 3)
    yield Signal(np.rec.fromarrays([values], dtype=np.dtype([("map", "<f4", (2, 3))])), t, name="map")
    curve = np.arange(n * 4, dtype="<i2").reshape(n, 4)
    yield Signal(np.rec.fromarrays([curve], dtype=np.dtype([("curve", "<i2", (4,))])), t, name="curve")
    yield Signal(np.arange(n * 5, dtype="u1").reshape(n, 5), t, name="bytes")


def invalid(t):
    bits = np.arange(len(t)) % 3 == 0
    yield Signal(np.arange(len(t), dtype="<f8"), t, name="invalid_f8", invalidation_bits=bits)
    yield Signal(np.arange(len(t), dtype="<u2"), t, name="invalid_u2", invalidation_bits=~bits)
    yield Signal(np.arange(len(t), dtype="<i4"), t, name="valid_i4")


def write(folder, version, compression, n):
    old = version < "4"
    file = MDF(version=version)
    t = np.arange(n) * 0.01
    file.append(numbers(t), comment="numbers")
    file.append(list(converted(t, old)), comment="conversions")
    file.append(numbers(np.arange(n // 3) * 0.03 + 1), comment="slower")
    if not old:
        file.append(list(texts(t)), comment="texts")
        file.append(list(arrays(t)), comment="arrays", common_timebase=True)
        file.append(list(invalid(t)), comment="invalid", common_timebase=True)
        file.append([Signal(np.arange(n) + 1j * np.arange(n), t, name="complex")], comment="complex")
        file.append(numbers(t, MORE_TYPES), comment="more types")
        file.append(list(nested(t)), comment="nested conversions")
        file.attach(b"some bytes" * 50, file_name="notes.txt", mime="text/plain")
        if version > "4.00":
            clocks(file, n)
    file.append([Signal(np.arange(4.0), np.arange(4.0) + 0.5, name="alone")], comment="few")
    ending = "mdf" if old else "mf4"
    file.save(folder / f"v{version.replace('.', '')}_c{compression}_{n}.{ending}", compression=compression, overwrite=True)
    file.close()


def leave_open(folder, name):
    """The file as a logger leaves it that lost its power: not closed, and numbers of records never written."""
    data = bytearray((folder / name).read_bytes())
    data[:8] = b"UnFinMF "
    data[60:62] = (1).to_bytes(2, "little")
    place = data.find(b"##CG")
    while place >= 0:
        count = place + 24 + 8 * int.from_bytes(data[place + 16 : place + 24], "little") + 8
        data[count : count + 8] = bytes(8)
        place = data.find(b"##CG", place + 4)
    (folder / f"open_{name}").write_bytes(data)


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for version in ("2.14", "3.00", "3.30"):
        write(folder, version, 0, 700)
    write(folder, "4.00", 0, 700)
    for version, compression in itertools.product(("4.10", "4.11", "4.20"), (0, 1, 2)):
        write(folder, version, compression, 700)
    # Zstandard and LZ4, plain and transposed.
    for compression in (3, 4, 5, 6):
        write(folder, "4.30", compression, 700)
    for compression in (0, 1, 2):
        write(folder, "4.10", compression, 60000)
    leave_open(folder, "v410_c0_700.mf4")


main()

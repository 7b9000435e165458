"""Writes down what asammdf reads in MDF files, for the tests of the crate to compare with.

    dump.py OUT FILE...

For each file, OUT/<number>.samples: a line `file<TAB>path`, then for each channel a line
`kind<TAB>group<TAB>name<TAB>unit<TAB>count` and its samples: for kind N, little-endian doubles; for T and B, texts (UTF-8)
and bytes, each after its length as four bytes; for L (listed only), nothing. Kind M is the clock of the group.
A file that asammdf cannot read gets a line `refused`.
"""

import logging
import struct
import sys
import warnings
from pathlib import Path

import asammdf
import numpy as np

warnings.filterwarnings("ignore")
logging.disable(logging.CRITICAL)


def line(out, kind, group, name, unit, count):
    fields = [kind, str(group), name, unit, str(count)]
    out.write(("\t".join(f.replace("\t", " ").replace("\n", " ").replace("\r", " ") for f in fields) + "\n").encode())


def numbers(out, kind, group, name, unit, values, invalid=None):
    values = np.asarray(values).astype("<f8")
    if invalid is not None and invalid.any():
        values = values.copy()
        values[invalid] = np.nan
    line(out, kind, group, name, unit, len(values))
    out.write(values.tobytes())


def strings(out, kind, group, name, unit, values):
    line(out, kind, group, name, unit, len(values))
    for value in values:
        out.write(struct.pack("<I", len(value)) + value)


def text(value, encoding):
    if isinstance(value, bytes):
        if encoding and encoding.startswith("utf-16"):
            # NumPy takes the NUL away in which the last character may end.
            value += b"\0" * (len(value) % 2)
        for name in (encoding, "utf-8", "latin-1"):
            try:
                value = value.decode(name) if name else value
                break
            except (UnicodeDecodeError, LookupError):
                continue
    if isinstance(value, bytes):
        value = value.decode("latin-1")
    return str(value).split("\0")[0].lstrip("\ufeff").encode()


def elements(out, group, name, unit, values, invalid):
    for index in np.ndindex(values.shape[1:]):
        suffix = "".join(f"[{i}]" for i in index)
        numbers(out, "N", group, name + suffix, unit, values[(slice(None), *index)], invalid)


def channel(out, group, name, unit, signal, encoding):
    values, invalid = signal.samples, signal.invalidation_bits
    invalid = None if invalid is None else np.asarray(invalid).astype(bool)
    if values.dtype.names:
        first = values[values.dtype.names[0]]
        is_array = values.dtype.names[0] == name and first.ndim > 1 and len(name) > 0
        if is_array and first.dtype.kind in "iufb":
            return elements(out, group, name, unit, first, invalid)
        return line(out, "L", group, name, unit, len(values))
    if values.ndim > 1:
        return strings(out, "B", group, name, unit, [row.tobytes() for row in values])
    if values.dtype.kind in "SUO":
        rows = [text(v, encoding) for v in values]
        if invalid is not None:
            rows = [b"" if bad else row for row, bad in zip(rows, invalid)]
        return strings(out, "T", group, name, unit, rows)
    if values.dtype.kind == "c":
        numbers(out, "N", group, name + ".re", unit, values.real, invalid)
        return numbers(out, "N", group, name + ".im", unit, values.imag, invalid)
    if values.dtype.kind in "iufb":
        return numbers(out, "N", group, name, unit, values, invalid)
    return line(out, "L", group, name, unit, len(values))


def dump(path, out):
    out.write(f"file\t{path}\n".encode())
    try:
        measurement = asammdf.MDF(path)
    except Exception as error:
        out.write(f"refused\t{str(error)[:200]!r}\n".encode())
        return
    for g, group in enumerate(measurement.groups):
        if group.channels:
            try:
                numbers(out, "M", g, "", "", measurement.get_master(g))
            except Exception as error:
                print(f"{path}: master of group {g}: {error!r}", file=sys.stderr)
        elements_of = None
        for c, block in enumerate(group.channels):
            # asammdf lists an array, then its elements at places that are not theirs; they are taken from the array.
            if elements_of and block.name.startswith(elements_of + "["):
                continue
            dependencies = group.channel_dependencies[c] or []
            is_array = any(type(d).__name__ == "ChannelArrayBlock" for d in dependencies)
            elements_of = block.name if is_array else None
            try:
                signal = measurement.get(group=g, index=c, ignore_invalidation_bits=True)
            except Exception as error:
                print(f"{path}: {block.name!r}: {error!r}", file=sys.stderr)
                line(out, "L", g, block.name, "?", 0)
                continue
            encoding = {8: "utf-16-le", 9: "utf-16-be"}.get(block.data_type, signal.encoding)
            channel(out, g, signal.name or block.name, signal.unit or "", signal, encoding)


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for number, path in enumerate(sys.argv[2:]):
        with open(folder / f"{number:04}.samples", "wb") as out:
            dump(path, out)


main()

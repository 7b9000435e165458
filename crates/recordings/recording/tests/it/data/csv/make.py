"""What Python's csv module and float() read in text files of shared/reference, with the place of the heading told by hand."""
import csv, math, sys, glob, os, struct

root = sys.argv[1]
# File (pattern), encoding, row of the names, row of the first samples, row of the units or None, seconds per unit of time.
files = [
    ("csv-quirks/*.csv", "utf-8", 0, 1, "brackets", 1e6),
    ("engine-ecu/032LP*.csv", "latin-1", 21, 24, 22, 1),
    ("engine-ecu/ME7*.csv", "latin-1", 21, 24, 22, 1),
    ("fmi/*_out.csv", "utf-8", 0, 1, None, 1),
    ("fmi/*_in.csv", "utf-8", 0, 1, None, 1),
]
skipped = {"String_output", "Binary_output", "String_input"}


def number(cell):
    cell = cell.strip()
    return {"true": 1.0, "false": 0.0, "": math.nan}.get(cell.lower(), None) if cell.lower() in ("true", "false", "") else float(cell)


def fnv(values):
    h = 0xCBF29CE484222325
    for b in struct.pack(f"<{len(values)}d", *values):
        h = ((h ^ b) * 0x100000001B3) & (2**64 - 1)
    return f"{h:016x}"


print("# What make.py reads: file, channel, unit, samples, FNV-1a of the time stamps and of the samples as little-endian doubles.")
for pattern, encoding, names_at, data_at, units_at, per_second in files:
    for path in sorted(glob.glob(f"{root}/{pattern}")):
        rows = list(csv.reader(open(path, encoding=encoding, newline="")))
        names = [c.strip() for c in rows[names_at]]
        data = [r for r in rows[data_at:] if any(c.strip() for c in r) and r != ["\x1a"]]
        if len(data[-1]) < len(names):
            data.pop()  # the file is cut off
        units = [""] * len(names)
        if units_at == "brackets":
            units = [n[n.rindex("(") + 1 : -1] if "(" in n else "" for n in names]
            names = [n[: n.rindex("(")] if "(" in n else n for n in names]
        elif units_at is not None:
            units = [c.strip() for c in rows[units_at]]
        time = fnv([float(r[0]) / per_second for r in data])
        for i, name in enumerate(names[1:], 1):
            if not name or name in skipped or " " in data[0][i].strip():
                continue
            values = [number(r[i]) for r in data]
            print("\t".join([os.path.relpath(path, root), name, units[i], str(len(values)), time, fnv(values)]))

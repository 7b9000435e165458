"""Times asammdf and our reader on the same files, each task in a process of its own.

    mdf.py FOLDER MEASURE    MEASURE is the built example `measure` of the crate

The files, plain.mf4 (1 GB) and packed.mf4 with 500 channels on five rasters, are written to the folder if they are not there.
"""

import re
import resource
import subprocess
import sys
import time
from pathlib import Path

TASKS = ("list", "five", "all")
REPEATS = 3


def make(folder):
    import numpy as np
    from asammdf import MDF, Signal
    from asammdf.blocks.conversion_utils import from_dict

    file = MDF(version="4.10")
    rng = np.random.default_rng(1)
    for raster, rate in enumerate((1000, 500, 500, 200, 100)):
        n = 1120 * rate
        t = np.arange(n) / rate
        base = np.cumsum(rng.standard_normal(n))
        signals = []
        for c in range(100):
            kind = ("<f8", "<f4", "<i2", "<u2", "<f4")[c % 5]
            conversion = from_dict({"a": 0.01, "b": -5.0}) if kind in ("<i2", "<u2") else None
            signals.append(Signal(np.abs(base * (c + 1)).astype(kind), t, unit="Nm", name=f"r{raster}_{c}", conversion=conversion))
        file.append(signals, comment=f"raster {raster}", common_timebase=True)
    for name, compression in (("plain", 0), ("packed", 2)):
        # A name only for what is whole.
        part = folder / f"{name}-part.mf4"
        file.save(part, compression=compression, overwrite=True)
        part.replace(folder / f"{name}.mf4")


def task(path, what):
    from asammdf import MDF

    start = time.perf_counter()
    file = MDF(path)
    opened = time.perf_counter() - start
    channels = sum(len(g.channels) for g in file.groups)
    samples = 0
    if what == "five":
        chosen = [(None, g, 10 + 20 * g) for g in range(5)]
        samples = sum(len(s.samples) for s in file.select(chosen))
    if what == "all":
        kept = []
        for g, group in enumerate(file.groups):
            kept += file.select([(None, g, c) for c in range(len(group.channels))])
        samples = sum(len(s.samples) for s in kept)
    wall = time.perf_counter() - start
    usage = resource.getrusage(resource.RUSAGE_SELF)
    print(
        f"asammdf {what}: {channels} channels, {samples} samples; open {opened:.4f} s, wall {wall:.4f} s, processor "
        f"{usage.ru_utime + usage.ru_stime:.2f} s, peak {usage.ru_maxrss / 1000:.0f} MB"
    )


def figures(command):
    """Wall and processor time in s and peak memory in MB, as a program says."""
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    line = next(line for line in reversed(lines) if " wall " in line)
    print(line, flush=True)
    return [float(re.search(rf"{what} ([0-9.]+)", line)[1]) for what in ("wall", "processor", "peak")]


def compare(folder, measure):
    rows = ["| file | task | wall s, ours / asammdf | wall × | processor s | processor × | peak MB |", "| --- | --- | --- | --- | --- | --- | --- |"]
    for name in ("plain", "packed"):
        path = folder / f"{name}.mf4"
        print(f"{path}: {path.stat().st_size / 1e6:.0f} MB", flush=True)
        for what in TASKS:
            # By turns, and of each the smallest: other work on the machine only adds.
            runs = [
                (figures([measure, path, what]), figures([sys.executable, __file__, "task", path, what]))
                for _ in range(REPEATS)
            ]
            ours, theirs = ([min(column) for column in zip(*side)] for side in zip(*runs))
            wall, processor, peak = zip(ours, theirs)
            ratio = lambda pair: f"{pair[1] / pair[0]:.1f}"
            both = lambda pair, digits: f"{pair[0]:.{digits}f} / {pair[1]:.{digits}f}"
            # The system counts processor time in hundredths of a second.
            counted = ratio(processor) if processor[0] >= 0.05 else "–"
            cells = [both(wall, 4), ratio(wall), both(processor, 2), counted]
            rows.append(" | ".join([f"| {name}", what, *cells, f"{peak[0]:.0f} / {peak[1]:.0f} |"]))
    print("\n".join(["", *rows]))


def main():
    if sys.argv[1] == "task":
        return task(*sys.argv[2:])
    folder = Path(sys.argv[1])
    if not all((folder / f"{name}.mf4").exists() for name in ("plain", "packed")):
        folder.mkdir(parents=True, exist_ok=True)
        make(folder)
    compare(folder, sys.argv[2])


main()

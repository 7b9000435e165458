"""Times asammdf and our reader on the same files, each task in a process of its own.

    bench.py make FOLDER           writes plain.mf4 (about 1 GB) and packed.mf4: 500 channels on five rasters
    bench.py run FOLDER MEASURE    MEASURE is the built example `measure` of the crate
"""

import resource
import subprocess
import sys
import time
from pathlib import Path

TASKS = ("list", "five", "all")


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
    file.save(folder / "plain.mf4", compression=0, overwrite=True)
    file.save(folder / "packed.mf4", compression=2, overwrite=True)


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
        f"asammdf {what}: {channels} channels, {samples} samples; open {opened:.4f} s, wall {wall:.3f} s, processor "
        f"{usage.ru_utime + usage.ru_stime:.2f} s, peak {usage.ru_maxrss / 1000:.0f} MB"
    )


def main():
    what, folder = sys.argv[1], Path(sys.argv[2])
    if what == "make":
        folder.mkdir(parents=True, exist_ok=True)
        return make(folder)
    if what == "task":
        return task(folder, sys.argv[3])
    for name in ("plain.mf4", "packed.mf4"):
        print(f"{name}: {(folder / name).stat().st_size / 1e6:.0f} MB", flush=True)
        for each in TASKS:
            subprocess.run([sys.argv[3], folder / name, each], check=True)
            subprocess.run([sys.executable, __file__, "task", folder / name, each], check=True)


main()

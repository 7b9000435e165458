"""Draws the table of `cargo xtask bench --commands --growth`: growth.py TABLE.md FIGURE.png. It needs matplotlib."""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

STYLES = ("-", "--", ":")


def courses(table):
    """Samples, CPU time in s and memory in MB of each command."""
    found = {}
    for line in table.splitlines():
        cells = [cell.strip() for cell in line.strip("| ").split("|")]
        if len(cells) == 6 and cells[1].isdigit():
            found.setdefault(cells[0], []).append((int(cells[1]), float(cells[3]), float(cells[4])))
    return found


def draw(found, file):
    figure, (time, memory) = plt.subplots(1, 2, figsize=(13, 6.5), sharex=True)
    for number, (command, points) in enumerate(found.items()):
        samples, seconds, megabytes = zip(*points, strict=True)
        style = STYLES[number // 10 % len(STYLES)]
        time.loglog(samples, seconds, style, marker="o", markersize=4, label=command)
        memory.loglog(samples, megabytes, style, marker="o", markersize=4)
    for axes, label in ((time, "CPU time, s"), (memory, "largest memory, MB")):
        axes.set_xlabel("samples")
        axes.set_ylabel(label)
        axes.grid(True, which="major", alpha=0.4)
    figure.legend(*time.get_legend_handles_labels(), loc="lower center", ncols=4, frameon=False, fontsize=9)
    figure.tight_layout(rect=(0, 0.14, 1, 1))
    figure.savefig(file, dpi=100)


draw(courses(Path(sys.argv[1]).read_text()), sys.argv[2])

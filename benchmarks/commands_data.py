"""Data of `commands.py`: commands_data.py STEM SAMPLES writes STEM.parquet and STEM.csv.

In a process of its own: what a process uses at most counts the memory that its parent had when it started it.
"""

import math
import sys
from pathlib import Path

SAMPLE_TIME_S = 1e-3
A = [1.0]
for radius, angle in ((0.9, 0.3), (0.7, 1.0)):
    pair = [1.0, -2.0 * radius * math.cos(angle), radius**2]
    A = [sum(A[i] * pair[k - i] for i in range(len(A)) if 0 <= k - i < 3) for k in range(len(A) + 2)]
B = [0.0, 0.5, 0.3, -0.2, 0.1]
B_2 = [0.0, 0.2, 0.1, 0.3, -0.1]
GAIN, LAG_S, DELAY_S = 2.0, 0.05, 0.013
"""Of the column `lag`, for continuous models."""


BLOCK = 10**6
"""Samples that are made and written at once, a multiple of HELD."""
HELD = 20


class Filter:
    """A filter from rest that goes on where the block before ended."""

    def __init__(self, b, a):
        self.b, self.a, self.state = b, a, [0.0] * (max(len(b), len(a)) - 1)

    def __call__(self, x):
        from scipy.signal import lfilter

        y, self.state = lfilter(self.b, self.a, x, zi=self.state)
        return y


def blocks(samples):
    """Columns: `y` ARX of `u`, `y2` ARX of `u` and `u2`, `oe` output error of `u`, `lag` first order with delay of `held`."""
    import numpy as np
    import pyarrow

    rng = np.random.default_rng(1)
    late = round(DELAY_S / SAMPLE_TIME_S)
    pole = math.exp(-SAMPLE_TIME_S / LAG_S)
    of_u, of_u2, noise_y, noise_y2 = Filter(B, A), Filter(B_2, A), Filter([1.0], A), Filter([1.0], A)
    of_held = Filter([0.0] * (late + 1) + [GAIN * (1.0 - pole)], [1.0, -pole])
    for first in range(0, samples, BLOCK):
        count = min(BLOCK, samples - first)
        u, u2, e, e2, noise = rng.standard_normal((5, count))
        held = np.repeat(np.sign(rng.standard_normal(-(-count // HELD))), HELD)[:count]
        driven = of_u(u)
        columns = {
            "u": u,
            "u2": u2,
            "held": held,
            "y": driven + noise_y(0.1 * e),
            "y2": of_u2(u2) + 0.3 * driven + noise_y2(0.1 * e2),
            "oe": driven + 0.3 * noise,
            "lag": of_held(held) + 0.1 * noise,
        }
        clock = (np.arange(first, first + count) * SAMPLE_TIME_S).round(3)
        yield pyarrow.table({"time_s": clock} | {k: v.round(9) for k, v in columns.items()})


def make_data(stem, samples):
    import pyarrow.csv
    import pyarrow.parquet

    # A name only for what is whole.
    parts = [stem.with_suffix(end + ".part") for end in (".parquet", ".csv")]
    parquet = csv = None
    for table in blocks(samples):
        parquet = parquet or pyarrow.parquet.ParquetWriter(parts[0], table.schema)
        csv = csv or pyarrow.csv.CSVWriter(
            parts[1], table.schema, write_options=pyarrow.csv.WriteOptions(quoting_style="none")
        )
        parquet.write_table(table)
        csv.write_table(table)
    parquet.close()
    csv.close()
    for part in parts:
        part.replace(part.with_suffix(""))


if __name__ == "__main__":
    make_data(Path(sys.argv[1]), int(sys.argv[2]))

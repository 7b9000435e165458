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


def make_data(stem, samples):
    """Columns: `y` ARX of `u`, `y2` ARX of `u` and `u2`, `oe` output error of `u`, `lag` first order with delay of `held`."""
    import numpy as np
    import pyarrow
    import pyarrow.csv
    import pyarrow.parquet
    from scipy.signal import lfilter

    rng = np.random.default_rng(1)
    u, u2, e, e2, noise = rng.standard_normal((5, samples))
    held = np.repeat(np.sign(rng.standard_normal(samples // 20 + 1)), 20)[:samples]
    y = lfilter(B, A, u) + lfilter([1.0], A, 0.1 * e)
    y2 = lfilter(B_2, A, u2) + 0.3 * lfilter(B, A, u) + lfilter([1.0], A, 0.1 * e2)
    late = round(DELAY_S / SAMPLE_TIME_S)
    pole = math.exp(-SAMPLE_TIME_S / LAG_S)
    lag = lfilter([0.0] * (late + 1) + [GAIN * (1.0 - pole)], [1.0, -pole], held) + 0.1 * noise
    columns = {"u": u, "u2": u2, "held": held, "y": y, "y2": y2, "oe": lfilter(B, A, u) + 0.3 * noise, "lag": lag}
    columns = {"time_s": (np.arange(samples) * SAMPLE_TIME_S).round(3)} | {k: v.round(9) for k, v in columns.items()}
    table = pyarrow.table(columns)
    # A name only for what is whole.
    part = stem.with_suffix(".part")
    pyarrow.parquet.write_table(table, part)
    part.replace(stem.with_suffix(".parquet"))
    pyarrow.csv.write_csv(table, part, pyarrow.csv.WriteOptions(quoting_style="none"))
    part.replace(stem.with_suffix(".csv"))


if __name__ == "__main__":
    make_data(Path(sys.argv[1]), int(sys.argv[2]))

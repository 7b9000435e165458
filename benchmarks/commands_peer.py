"""One task of `commands.py` with numpy and scipy, as a script of a user would do it: commands_peer.py TASK FILE"""

import json
import sys

import numpy as np


def columns(file, *names):
    if file.endswith(".mf4"):
        from asammdf import MDF

        with MDF(file) as recording:
            return [signal.samples for signal in recording.select(list(names))]
    if file.endswith(".parquet"):
        import pyarrow.parquet

        table = pyarrow.parquet.read_table(file, columns=list(names))
    else:
        import pyarrow.csv

        table = pyarrow.csv.read_csv(file)
    return [table[name].to_numpy() for name in names]


def regressors(u, y, na, nb, nk):
    """Rows from the first sample with all its past on; and the samples they explain."""
    first = max(na, nb + nk - 1)
    past = [-y[first - k : len(y) - k] for k in range(1, na + 1)]
    inputs = [u[first - k : len(u) - k] for k in range(nk, nk + nb)]
    return np.column_stack(past + inputs), y[first:]


def arx(file):
    u, y = columns(file, "u", "y")
    rows, seen = regressors(u, y, 4, 4, 1)
    return np.linalg.lstsq(rows, seen, rcond=None)[0].tolist()


def oe(file):
    from scipy.optimize import least_squares
    from scipy.signal import lfilter

    u, y = columns(file, "u", "oe")
    rows, seen = regressors(u, y, 4, 4, 1)
    start = np.linalg.lstsq(rows, seen, rcond=None)[0]
    delayed = lambda x, k: np.concatenate([np.zeros(k), x[: len(x) - k]])

    def error(p):
        return lfilter(np.concatenate([[0.0], p[4:]]), np.concatenate([[1.0], p[:4]]), u) - y

    def jacobian(p):
        f = np.concatenate([[1.0], p[:4]])
        filtered_u, filtered_y = lfilter([1.0], f, u), lfilter([1.0], f, lfilter(np.concatenate([[0.0], p[4:]]), f, u))
        return np.column_stack([-delayed(filtered_y, k) for k in range(1, 5)] + [delayed(filtered_u, k) for k in range(1, 5)])

    return least_squares(error, start, jacobian, method="lm").x.tolist()


def process(file):
    """Gain, lag and delay: the best of all delays of whole samples up to 50 ms, on the first tenth; then both others on all."""
    from scipy.optimize import least_squares
    from scipy.signal import lfilter

    u, y = columns(file, "held", "lag")
    step = 1e-3

    def error(p, late, n):
        pole = np.exp(-step / p[1])
        driven = np.concatenate([np.zeros(late + 1), u[: n - late - 1]])
        return lfilter([p[0] * (1.0 - pole)], [1.0, -pole], driven) - y[:n]

    short = min(len(u), 20_000)
    fits = [(least_squares(error, [1.0, 0.02], args=(late, short)), late) for late in range(0, 51, 1)]
    start, late = min(fits, key=lambda one: one[0].cost)
    found = least_squares(error, start.x, args=(late, len(u)))
    return [found.x[0], found.x[1], late * step]


def welch(file):
    from scipy.signal import csd, welch as auto

    u, y = columns(file, "u", "y")
    _, s_uu = auto(u, 1e3, nperseg=2048)
    _, s_yu = csd(u, y, 1e3, nperseg=2048)
    return np.abs(s_yu / s_uu)[:8].tolist()


def delay(file):
    u, y = columns(file, "held", "lag")

    def cost(late):
        rows, seen = regressors(u[:200_000], y[:200_000], 2, 2, late)
        return np.linalg.lstsq(rows, seen, rcond=None)[1][0]

    return [min(range(1, 51), key=cost)]


def convert(file):
    import pyarrow.csv
    import pyarrow.parquet

    pyarrow.parquet.write_table(pyarrow.csv.read_csv(file), file + ".peer.parquet")
    return []


task, file = sys.argv[1:]
print(json.dumps({"arx": arx, "oe": oe, "process": process, "welch": welch, "delay": delay, "convert": convert}[task](file)))

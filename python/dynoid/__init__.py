"""Recordings of a dynamometer test bench in, a validated bench model out; and a toolbox for linear models of any system.

>>> import numpy as np, dynoid
>>> random = np.random.default_rng(1)
>>> u = random.standard_normal(2000)
>>> y = np.zeros(2000)
>>> for t in range(2, 2000):
...     y[t] = 1.5 * y[t - 1] - 0.7 * y[t - 2] + u[t - 1] + 0.1 * random.standard_normal()
>>> data = dynoid.Dataset(y, u, sample_time=0.1)
>>> estimation, validation = data.split(0.6)
>>> fit = dynoid.fit.arx(estimation, na=2, nb=1, nk=1)
>>> low, high = fit.intervals(0.95)["a1"]
>>> low < -1.5 < high
True
>>> dynoid.compare([fit], validation).fit_percent[0][0][0] > 90
True
"""

import os
from pathlib import Path

from . import errors, fit, plots, result, results
from ._dynoid import Dataset, Fit, Recording, compare, dataset
from ._version import __version__
from .bench import Bench
from .explore import delay, order, recursive, spectrum
from .frames import from_frame, read
from .model import BenchModel, diff, export
from .study import Study

__all__ = [
    "Bench",
    "BenchModel",
    "Dataset",
    "Fit",
    "Recording",
    "Study",
    "__version__",
    "compare",
    "dataset",
    "delay",
    "diff",
    "errors",
    "export",
    "fit",
    "from_frame",
    "load",
    "order",
    "plots",
    "read",
    "recursive",
    "result",
    "results",
    "spectrum",
]


def load(path: str | os.PathLike[str]) -> Fit:
    """The estimate of a model file, as `dynoid fit --out` or `Fit.save` wrote it."""
    return Fit.from_json(Path(path).read_text(encoding="utf-8"))

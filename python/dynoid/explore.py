"""What data say before a model is chosen: spectra, delays and orders."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal

from . import _dynoid
from ._dynoid import Dataset
from .result import Facts, Result
from .results import Trajectory

Method = Literal["welch", "blackman-tukey", "lpm", "lrm", "etfe"]
Progress = Callable[[float, str], object]
Range = int | tuple[int, int]


class Spectra(Result):
    """Power spectra, or frequency responses, with their bands and peaks."""

    table = "spectra.peaks"
    spectra: list[Facts]


class Delays(Result):
    """The delay of each channel by several methods, each with its interval."""

    table = "delay"


class Orders(Result):
    """ARX structures, ranked by several criteria."""

    table = "structures"
    best: Facts
    """The structure that each criterion likes best."""
    at_edge: list[Any]
    structures: list[Facts]

    def rows(self, table: str | None = None) -> list[dict[str, Any]]:
        """A row a structure: its orders, its loss, and each criterion under its own name."""
        if table not in (None, self.table):
            return super().rows(table)
        return [_row(structure) for structure in self.to_dict()["structures"]]


def _row(structure: dict[str, Any]) -> dict[str, Any]:
    orders = {name: structure[name] for name in ("na", "nb", "nk")}
    rest = {name: value for name, value in structure.items() if name != "criteria"}
    criteria: dict[str, Any] = structure["criteria"]
    return orders | rest | criteria


def spectrum(
    data: Dataset, *, method: Method | None = None, period: float | None = None, window: int | None = None
) -> Spectra:
    """Of each experiment the power spectra of the outputs, or, where there are inputs, the responses of each output to them.

    Without a method, power is by Welch, and responses by local polynomials or rational functions. Inputs that repeat are averaged over their periods:
    `period` in s, or found. `window` counts the samples of a segment or of the lag window.
    """
    return Spectra(_dynoid.spectra(data, method, period, window))


def delay(
    data: Dataset, *, longest: int = 30, progress: Progress | None = None, threads: int | None = None
) -> Delays:
    """The dead time of each channel, up to so many samples, by several methods."""
    return Delays(_dynoid.delays(data, longest, progress, threads))


def order(
    data: Dataset,
    *,
    na: Range = (1, 6),
    nb: Range = (1, 6),
    nk: Range = (1, 6),
    validation: Dataset | None = None,
    progress: Progress | None = None,
    threads: int | None = None,
) -> Orders:
    """All ARX structures of these orders, each a number or the first and the last, ranked by several criteria."""
    ends = [one if isinstance(one, tuple) else (one, one) for one in (na, nb, nk)]
    return Orders(_dynoid.orders(data, ends[0], ends[1], ends[2], validation, progress, threads))


def recursive(
    data: Dataset,
    *,
    na: int = 0,
    nb: int | Sequence[int] = 0,
    nc: int = 0,
    nf: int | Sequence[int] = 0,
    nk: int | Sequence[int] = 1,
    forgetting: float = 1.0,
    drift: tuple[Sequence[float], float] | None = None,
    gradient: float | None = None,
) -> Trajectory:
    """The parameters of ARX, of ARMAX (`nc`) or of output error (`nf`) after each sample, for parameters that change.

    `forgetting` is the weight of a sample against the one after it: 1 for parameters that stay. `drift` has instead the standard deviations of the
    steps that the parameters take each sample, and the variance of the noise; `gradient` steps of this length, from 0 to 2, along the gradient.
    """
    wanted = None if drift is None else (list(drift[0]), drift[1])
    return _dynoid.recursive(data, na, nb, nc, nf, nk, forgetting, wanted, gradient)

"""Studies of a bench."""

from __future__ import annotations

import os
from collections.abc import Callable

from . import _dynoid
from ._dynoid import Made, Recording
from .model import BenchModel
from .result import Facts, Result


class Study(Result):
    """Everything learnt from the recordings of a bench. In a notebook it shows its report."""

    table = "estimates"
    bench: str
    """Name of the bench."""
    verdict: Facts
    """Judgement of the study, with its rules."""
    estimates: list[Facts]
    """Key numbers: each with its part, quantity, value, standard error and 95 % interval, in SI."""
    not_estimated: list[Facts]
    """Parts that are not estimated, and what they need."""
    findings: list[Facts]
    recordings: list[Facts]
    model: BenchModel | None
    """The bench model; none where the recordings give none."""
    series: Recording | None
    """Measured and modelled signals; none where nothing was estimated."""
    full: Result | None
    """The report with all analyses, where it was wanted."""

    def __init__(self, made: Made, model: BenchModel | None, series: Recording | None, full: Result | None) -> None:
        super().__init__(made)
        self.model, self.series, self.full = model, series, full

    @classmethod
    def run(
        cls,
        bench: str | os.PathLike[str],
        *,
        out: str | os.PathLike[str] | None = None,
        full: bool = False,
        overwrite: bool = False,
        progress: Callable[[float, str], object] | None = None,
        threads: int | None = None,
    ) -> Study:
        """Studies a bench with the recordings that its file lists.

        With `out`, a folder, the files of `dynoid study` are written. `full` adds all analyses, which takes minutes. `progress` is called with the
        part that is done, from 0 to 1, and with the step under way. An exception that it raises ends the study, and so does Ctrl-C.
        """
        return of_bench(_dynoid.Bench(bench, None), out, full, overwrite, progress, threads)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Study:
        """The study of a `study.json`, with the table of series beside it."""
        return _study(_dynoid.read_study(path), None)

    @property
    def level(self) -> str:
        """The verdict in a word: `good`, `reservations` or `insufficient`."""
        return str(self.verdict.level)


def of_bench(
    bench: _dynoid.Bench,
    out: str | os.PathLike[str] | None,
    full: bool,
    overwrite: bool,
    progress: Callable[[float, str], object] | None,
    threads: int | None,
) -> Study:
    """The study of a bench that was read."""
    return _study(*bench.study(out, full, overwrite, progress, threads))


def _study(studied: tuple[Made, str | None, Recording | None], full: Made | None) -> Study:
    made, model, series = studied
    return Study(made, None if model is None else BenchModel(model), series, None if full is None else Result(full))

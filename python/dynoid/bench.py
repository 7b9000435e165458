"""A bench: what its recordings show, and what is tried on it before it is run."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any, Literal

from . import _dynoid
from ._dynoid import Recording
from .model import BenchModel, given
from .result import (
    Capability,
    Check,
    Controller,
    Design,
    Engine,
    Friction,
    Lines,
    NextExperiments,
    Run,
    Shaft,
    Simulation,
    TorqueControl,
    TorqueSignals,
    Verdict,
)
from .study import Study, of_bench

Path = str | os.PathLike[str]
Progress = Callable[[float, str], object]
Model = Study | BenchModel | str | os.PathLike[str] | None
Number = float | str


class Bench:
    """A bench, as its bench file describes it. Its recordings are read once, when they are first needed.

    `recordings` takes the place of the files that the bench file lists. The keywords `progress` and `threads` of all methods are those of
    `Study.run`. `model` is a study, a bench model or the file of one; without it the bench is known by its bench file alone. Further keywords are
    numbers of the experiment or test, such as `speed=1500` or `torque="35 Nm"`.
    """

    def __init__(self, path: Path, recordings: Sequence[Recording] | None = None) -> None:
        self._bench = _dynoid.Bench(path, None if recordings is None else list(recordings))

    @property
    def name(self) -> str:
        """Name of the bench."""
        return self._bench.name

    @property
    def path(self) -> str:
        """Place of the bench file."""
        return self._bench.path

    @property
    def text(self) -> str:
        """Text of the bench file."""
        return self._bench.text

    def recordings(self, *, progress: Progress | None = None, threads: int | None = None) -> dict[str, str]:
        """The recordings that can be used, each with the label of its experiment."""
        return dict(self._bench.recordings(progress, threads)[0])

    def doubts(self, *, progress: Progress | None = None, threads: int | None = None) -> list[str]:
        """Doubts about the recordings, and why some cannot be used."""
        return self._bench.recordings(progress, threads)[1]

    def study(
        self,
        *,
        out: Path | None = None,
        full: bool = False,
        overwrite: bool = False,
        progress: Progress | None = None,
        threads: int | None = None,
    ) -> Study:
        """Studies the recordings, as `Study.run` does."""
        return of_bench(self._bench, out, full, overwrite, progress, threads)

    def lines(self, *, progress: Progress | None = None, threads: int | None = None) -> Lines:
        """The lines of the spectra of each recording, and their causes."""
        return Lines(self._bench.lines(progress, threads))

    def torque_signals(self, *, progress: Progress | None = None, threads: int | None = None) -> TorqueSignals:
        """The torque signals against each other, and the shaft torque rebuilt."""
        return TorqueSignals(self._bench.torque_signals(progress, threads))

    def torque_control(
        self,
        *,
        highest_order: int = 6,
        longest_delay: int = 4,
        progress: Progress | None = None,
        threads: int | None = None,
    ) -> TorqueControl:
        """Models of the torque control up to these orders and delays in samples, compared."""
        return TorqueControl(self._bench.torque_control(highest_order, longest_delay, progress, threads))

    def controller(self, *, progress: Progress | None = None, threads: int | None = None) -> Controller:
        """The speed controller and its feed-forward."""
        return Controller(self._bench.controller(progress, threads))

    def shaft(self, *, progress: Progress | None = None, threads: int | None = None) -> Shaft:
        """The shaft of every recording, and of all together."""
        return Shaft(self._bench.shaft(progress, threads))

    def engine(self, *, progress: Progress | None = None, threads: int | None = None) -> Engine:
        """The engine's torque, rebuilt."""
        return Engine(self._bench.engine(progress, threads))

    def friction(self, *, progress: Progress | None = None, threads: int | None = None) -> Friction:
        """Friction and inertia of the dynamometer, from the recordings without shaft."""
        return Friction(self._bench.friction(progress, threads))

    def next(
        self,
        *,
        speed: float = 1200.0,
        duration: float = 60.0,
        enough: float = 0.01,
        seed: int = 1,
        progress: Progress | None = None,
        threads: int | None = None,
    ) -> NextExperiments:
        """Gains from each further experiment of this speed in rpm and duration in s.

        An interval within this part of the value is narrow `enough`. There may be no recordings yet.
        """
        return NextExperiments(self._bench.next(speed, duration, enough, seed, progress, threads))

    def can(
        self,
        test: str | os.PathLike[str],
        *,
        model: Model = None,
        engine_map: Path | None = None,
        idle: float | None = None,
        vehicle: Path | None = None,
        by: Sequence[str] = (),
        require: Sequence[str] = (),
        samples: int = 200,
        seed: int = 1,
        progress: Progress | None = None,
        threads: int | None = None,
        **numbers: Number,
    ) -> Verdict:
        """Predicts a test on benches drawn from what is known of this one.

        `test` is a cycle, a shape, an experiment, or a file of demands or of a cycle, as `dynoid can` names them. `by` names requirement sets, and
        `require` has requirements of your own, such as `"speed overshoot below 5 %"`.
        """
        wanted = _wanted(engine_map, idle, vehicle, by, require)
        tried = _tried(test, numbers, samples, seed)
        return Verdict(_dynoid.can(self._bench, tried, wanted, given(model), progress, threads))

    def judge(
        self,
        recording: Path,
        test: str | os.PathLike[str],
        *,
        engine_map: Path | None = None,
        idle: float | None = None,
        vehicle: Path | None = None,
        by: Sequence[str] = (),
        require: Sequence[str] = (),
        start: float | None = None,
        seed: int = 1,
        progress: Progress | None = None,
        threads: int | None = None,
        **numbers: Number,
    ) -> Run:
        """Judges a recorded run of a test by requirements. It begins at `start` in s, or where the speed shows it."""
        wanted = _wanted(engine_map, idle, vehicle, by, require)
        tried = _tried(test, numbers, 1, seed)
        return Run(_dynoid.judge(self._bench, recording, tried, wanted, start, progress, threads))

    def capability(
        self,
        *,
        model: Model = None,
        speed: float | None = None,
        torque: float | None = None,
        want: Sequence[str] = (),
        samples: int = 200,
        seed: int = 1,
        progress: Progress | None = None,
        threads: int | None = None,
    ) -> Capability:
        """The largest sines and gradients that the bench can do at a speed in rpm and a mean torque in Nm.

        `want` has sines and gradients that are wanted, such as `"100 rpm at 2 Hz"`.
        """
        draws = (samples, seed)
        found = _dynoid.capability(self._bench, speed, torque, list(want), draws, given(model), progress, threads)
        return Capability(found)

    def design(
        self,
        experiment: str | os.PathLike[str] | None = None,
        *,
        optimal: Sequence[str] = (),
        form: Literal["multisine", "binary"] = "multisine",
        peak_shaft_torque: float | None = None,
        peak_torque: float | None = None,
        peak_speed: float | None = None,
        model: Model = None,
        seed: int = 1,
        progress: Progress | None = None,
        threads: int | None = None,
        **numbers: Number,
    ) -> Design:
        """The demands of an experiment, and the prediction of what the bench will do.

        In place of an experiment, `optimal` names parameters from K, B, J_d, J_e, PI, FF and TC: the excitation is designed for the least variance of
        these. The largest deviations from the mean are in Nm and rpm.
        """
        if (experiment is None) == (not optimal):
            raise ValueError("name an experiment, or give `optimal` the parameters that it is to teach")
        peaks = {"peak_shaft_torque": peak_shaft_torque, "peak_torque": peak_torque, "peak_speed": peak_speed}
        choices: dict[str, Any] | None = {"goals": list(optimal), "form": form, **peaks} if optimal else None
        tried = _tried(experiment or "optimal", numbers, 1, seed)
        return Design(*_dynoid.design(self._bench, tried, choices, given(model), progress, threads))

    def check(
        self,
        experiment: str | os.PathLike[str],
        *,
        model: Model = None,
        samples: int = 200,
        seed: int = 1,
        progress: Progress | None = None,
        threads: int | None = None,
        **numbers: Number,
    ) -> Check:
        """The probability that an experiment reaches each limit of the bench."""
        tried = _tried(experiment, numbers, samples, seed)
        return Check(_dynoid.check(self._bench, tried, given(model), progress, threads))

    def simulate(
        self,
        experiment: str | os.PathLike[str],
        *,
        truth: bool = False,
        model: Model = None,
        seed: int = 1,
        progress: Progress | None = None,
        threads: int | None = None,
        **numbers: Number,
    ) -> Simulation:
        """An experiment on the virtual bench of the bench file; with `truth`, the true signals too."""
        tried = _tried(experiment, numbers, 1, seed)
        return Simulation(*_dynoid.simulate(self._bench, tried, truth, given(model), progress, threads))

    def __repr__(self) -> str:
        return f"{self.name}: {self.path}"


def _tried(name: str | os.PathLike[str], numbers: dict[str, Number], benches: int, seed: int) -> dict[str, Any]:
    values = {key: str(value) for key, value in numbers.items()}
    return {"name": os.fspath(name), "numbers": values, "benches": benches, "seed": seed}


def _wanted(
    engine_map: Path | None, idle: float | None, vehicle: Path | None, by: Sequence[str], require: Sequence[str]
) -> dict[str, Any]:
    return {"engine_map": engine_map, "idle": idle, "vehicle": vehicle, "by": list(by), "require": list(require)}

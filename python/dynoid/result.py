"""Results of a bench: their numbers, their page, and all of them as a document."""

from __future__ import annotations

import html
import json
import os
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar

from ._dynoid import Made, Recording

if TYPE_CHECKING:
    import pandas
    import polars

Facts = SimpleNamespace
"""Numbers by their names, as attributes."""


class Result:
    """A result of the library. Its numbers are attributes, with the names that the command's JSON has.

    In a notebook it shows its page with the figures, and elsewhere the page as text. Pickles and copies are equal to it.
    """

    table: ClassVar[str]
    """The list of which frames are made, unless another is named; `a.b` are the lists `b` of all entries of `a`."""

    def __init__(self, made: Made) -> None:
        self._made = made

    def __getattr__(self, name: str) -> Any:
        # A number is named; what begins with an underscore is Python's.
        if name.startswith("_"):
            raise AttributeError(name)
        if "_facts" not in self.__dict__:
            self._facts = json.loads(self._made.facts, object_hook=lambda entries: Facts(**entries))
        return getattr(self._facts, name)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.to_dict()]

    def to_dict(self) -> dict[str, Any]:
        """The numbers as dictionaries and lists; `None` where one is not known."""
        numbers: dict[str, Any] = json.loads(self._made.facts)
        return numbers

    def to_json(self) -> str:
        """The numbers as JSON."""
        return self._made.facts

    @property
    def document(self) -> dict[str, Any] | None:
        """All of the result with its long series, which the numbers leave out; none where the numbers are all."""
        return None if self._made.document is None else json.loads(self._made.document)

    @property
    def notes(self) -> list[str]:
        """What should be known of the result, in words."""
        return self._made.notes

    def rows(self, table: str | None = None) -> list[dict[str, Any]]:
        """The entries of a list as rows: each with its numbers, and those of the entries that it belongs to.

        Lists of further entries are left out: they make rows of their own, under their own name.
        """
        return _rows(self.to_dict(), (table or self.table).split("."))

    def to_pandas(self, table: str | None = None) -> pandas.DataFrame:
        """The rows as a frame of pandas."""
        import pandas

        return pandas.DataFrame(self.rows(table))

    def to_polars(self, table: str | None = None) -> polars.DataFrame:
        """The rows as a frame of polars."""
        import polars

        return polars.DataFrame(self.rows(table), infer_schema_length=None)

    def text(self) -> str:
        """The page as text."""
        return self._made.text()

    def markdown(self) -> str:
        """The page as Markdown."""
        return self._made.markdown()

    def html(self) -> str:
        """The page for a browser, with its figures, in one piece."""
        return self._made.html()

    def svg(self) -> str:
        """The figures of the page as one SVG."""
        return self._made.svg()

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes the page (.html, .pdf) or its figures (.svg, .png).

        A file that dynoid did not write is replaced only where `overwrite` allows it.
        """
        self._made.save(path, overwrite)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Result) or type(self) is not type(other):
            return NotImplemented
        return self._made.facts == other._made.facts and self._made.document == other._made.document

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return self.text()

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{html.escape(self.html())}" style="width: 100%; height: 40em; border: 0"></iframe>'


class Answer(Result):
    """A result that answers a question."""

    @property
    def is_yes(self) -> bool:
        """True where the answer is yes, and all limits of the bench were checked."""
        return bool(self._made.is_yes)


def _rows(facts: dict[str, Any], path: list[str]) -> list[dict[str, Any]]:
    found: list[tuple[dict[str, Any], Any]] = [({}, facts)]
    for name in path:
        below = []
        for above, entry in found:
            inner = entry.get(name)
            own = above | {key: value for key, value in _flat(entry).items() if not isinstance(value, list)}
            own = {key: value for key, value in own.items() if key.split(".")[0] != name}
            below += [(own, one) for one in (inner if isinstance(inner, list) else [inner] if inner else [])]
        found = below
    rows = [above | _flat(entry) for above, entry in found]
    return [{key: value for key, value in row.items() if not _has_entries(value)} for row in rows]


def _has_entries(value: Any) -> bool:
    return isinstance(value, list) and any(isinstance(entry, (dict, list)) for entry in value)


def _flat(entry: Any) -> dict[str, Any]:
    """An entry without nesting: names joined by points, and the ends of an interval as `low` and `high`."""
    if not isinstance(entry, dict):
        return {"value": entry}
    flat: dict[str, Any] = {}
    for key, value in entry.items():
        if isinstance(value, dict):
            flat |= {f"{key}.{inner}": number for inner, number in _flat(value).items()}
        elif key == "interval" and isinstance(value, list) and len(value) == 2:
            flat |= {"low": value[0], "high": value[1]}
        else:
            flat[key] = value
    return flat


class Lines(Result):
    """The lines of the spectra of each recording, and their causes."""

    table = "recordings.parts.signals.lines"
    recordings: list[Facts]
    over_speed: list[Facts]
    """Orders over the speed, where the speed changes within or between recordings."""


class TorqueSignals(Result):
    """The torque signals against each other, and the shaft torque rebuilt."""

    table = "recordings"
    recordings: list[Facts]
    trust: Facts | None


class TorqueControl(Result):
    """Models of the torque control, compared with a delay of one sample."""

    table = "judgements"
    recordings: list[Facts]
    judgements: list[Facts]
    visibility: Facts | None
    unusable: list[Any]


class Controller(Result):
    """The speed controller of each recording, and its feed-forward."""

    table = "controllers"
    controllers: list[Facts]
    feed_forward: list[Facts]
    limits: list[Facts]


class Shaft(Result):
    """The shaft of every recording, and of all together."""

    table = "recordings"
    recordings: list[Facts]
    together: Facts | None


class Engine(Result):
    """The engine's torque, rebuilt. Its samples are in `document`."""

    table = "recordings"
    masses: Facts
    recordings: list[Facts]


class Friction(Result):
    """Friction and inertia of the dynamometer."""

    table = "curve"
    inertia: Facts
    friction: Facts
    per_inertia: Facts
    candidates: list[Facts]
    curve: list[Facts]
    used: list[Facts]


class NextExperiments(Result):
    """Gains from each further experiment."""

    table = "candidates"
    candidates: list[Facts]


class Verdict(Answer):
    """The answer to whether a bench can run a test, how probably, and what limits it."""

    table = "limits"
    test: str
    duration_s: float
    answer: str
    sentence: str
    beyond: list[Facts]
    kept: Facts
    """The part of the benches that keep everything."""
    unstable: Facts
    samples: int
    limits: list[Facts]
    unchecked: list[str]
    """Limits that the bench file does not state."""
    requirements: list[Facts]
    own: list[Facts]
    easier: list[Facts]
    """Changes that would make a no a yes."""
    doubts: list[Any]
    spread: str
    engine_pulses: Facts
    assumptions: list[Any]
    friction: Facts
    engine_following: Facts | None


class Run(Answer):
    """A recorded run of a test, judged by requirements."""

    table = "requirements"
    test: str
    file: str
    passes: bool
    start_s: float
    speed: str | None
    torque: str | None
    limits_refer_to: Facts
    remarks: list[str]
    requirements: list[Facts]
    own: list[Facts]


class Capability(Answer):
    """The largest sines over frequency and speed that a bench can do, and the largest gradients."""

    table = "gradients"
    bench: str
    torque_nm: float
    unchecked: list[str]
    beyond: list[Facts]
    friction: Facts
    engine_pulses: Facts
    wanted: list[Facts]
    maps: list[Facts]
    gradients: list[Facts]


class Check(Answer):
    """The probability that an experiment reaches each limit of the bench; yes means that it is safe."""

    table = "limits"
    label: str
    speeds_rpm: tuple[float, float]
    """The lowest and the highest speed demanded."""
    duration_s: float
    verdict: str
    samples: int
    spread: Facts
    limits: list[Facts]
    unstable: Facts
    any_limit: Facts
    unchecked: list[str]
    thermal: Facts | None
    sines: Facts | None
    engine_pulses: Facts
    assumptions: list[Any]
    friction: Facts
    beyond: list[str]


class Design(Result):
    """An experiment that is ready to be run."""

    table = "demands"
    recording: Recording
    """The demands, each on its own clock."""
    response: Recording | None
    """What the bench will do; none where nothing is predicted, and `notes` says why."""
    label: str
    duration_s: float
    demands: list[Facts]
    prediction: Facts | None
    optimal: Facts | None

    def __init__(self, made: Made, recording: Recording, response: Recording | None) -> None:
        super().__init__(made)
        self.recording, self.response = recording, response


class Simulation(Result):
    """An experiment on the virtual bench."""

    table = "channels"
    recording: Recording
    """The recording, with the channels of the bench file."""
    truth: Recording | None
    """The true signals, without sensors, where they are wanted."""
    label: str
    duration_s: float
    seed: int
    channels: list[Facts]
    assumptions: list[Any]

    def __init__(self, made: Made, recording: Recording, truth: Recording | None) -> None:
        super().__init__(made)
        self.recording, self.truth = recording, truth


class Difference(Answer):
    """Two bench models, compared; yes means that the bench has changed."""

    table = "parts.parameters"

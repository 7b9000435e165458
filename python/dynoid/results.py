"""Results as plain dataclasses. They can be copied, pickled, compared by hand, and turned into dictionaries and frames."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pandas
    import polars

    from .plots import Backend

Floats = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
Interval = tuple[float, float]


class Columns:
    """A result of columns of one length."""

    def to_dict(self) -> dict[str, Any]:
        """The columns by their names."""
        named = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}  # type: ignore[arg-type]
        return {name: column for name, column in named.items() if isinstance(column, (np.ndarray, list))}

    def to_pandas(self) -> pandas.DataFrame:
        """The columns as a frame of pandas."""
        import pandas

        return pandas.DataFrame(self.to_dict())

    def to_polars(self) -> polars.DataFrame:
        """The columns as a frame of polars."""
        import polars

        return polars.DataFrame(self.to_dict())


@dataclass(frozen=True, eq=False)
class Channel(Columns):
    """A channel of a recording."""

    name: str
    """Its name in the file."""
    unit: str
    """Its unit, as the file writes it; empty where it gives none."""
    comment: str
    """Its description in the file."""
    clock: int
    """Which of the recording's clocks it is on, from zero."""
    time: Floats
    """Time stamps, s."""
    values: Floats
    """Samples; NaN where they are missing."""


@dataclass(frozen=True, eq=False)
class ParameterTable(Columns):
    """Parameters with their standard errors and intervals."""

    name: list[str]
    value: Floats
    standard_error: Floats
    low: Floats
    high: Floats
    level: float
    """Probability with which each interval holds the parameter."""


@dataclass(frozen=True, eq=False)
class Bode(Columns):
    """A frequency response with its bands."""

    w: Floats
    """Angular frequency, rad/s."""
    magnitude: Floats
    low: Floats
    """Lower edge of the band of the magnitude."""
    high: Floats
    """Upper edge of the band of the magnitude."""
    phase: Floats
    """Unwrapped phase, degrees."""
    phase_low: Floats
    phase_high: Floats
    level: float
    """Probability with which a band holds the response at each single frequency."""
    output: str
    input: str

    @property
    def response(self) -> Complexes:
        """The response as complex numbers."""
        return np.asarray(self.magnitude * np.exp(1j * np.deg2rad(self.phase)), dtype=np.complex128)

    def plot(self, axes: Any = None, *, backend: Backend = "matplotlib") -> Any:
        """Draws magnitude and phase. Returns the two axes of matplotlib, or the figure of plotly."""
        from .plots import bode

        return bode(self, axes, backend=backend)

    def nyquist(self, axes: Any = None, *, backend: Backend = "matplotlib") -> Any:
        """Draws the response in the complex plane. Returns the axes of matplotlib, or the figure of plotly."""
        from .plots import nyquist

        return nyquist(self, axes, backend=backend)


@dataclass(frozen=True, eq=False)
class Step(Columns):
    """A step response with its band."""

    time: Floats
    """Time, s."""
    response: Floats
    low: Floats
    high: Floats
    level: float
    """Probability with which the band holds the response at each single instant."""
    output: str
    input: str

    def plot(self, axes: Any = None, *, backend: Backend = "matplotlib") -> Any:
        """Draws the response. Returns the axes of matplotlib, or the figure of plotly."""
        from .plots import step

        return step(self, axes, backend=backend)


@dataclass(frozen=True, eq=False)
class Root:
    """A pole or a zero, in s or z, with what it means and how certain that is."""

    value: complex
    natural_frequency: float
    """rad/s."""
    natural_frequency_interval: Interval | None
    damping: float
    damping_interval: Interval | None
    time_constant: float
    """s."""
    time_constant_interval: Interval | None
    covariance: Floats
    """Covariance of real and imaginary part."""
    near_multiple: bool
    """True where it lies so near another root that its intervals mean nothing."""


@dataclass(frozen=True, eq=False)
class StateSpace:
    """A system in state space, in the model's own time."""

    A: Floats
    B: Floats
    C: Floats
    D: Floats
    sample_time: float | None
    """s; none in continuous time."""
    delays: Floats
    """Delays that the matrices leave out, outputs × inputs, s."""
    inputs: list[str]
    outputs: list[str]


@dataclass(frozen=True, eq=False)
class Innovations:
    """A model in innovations form: x(t+1) = A x + B u + K e, y = C x + D u + e."""

    A: Floats
    B: Floats
    C: Floats
    D: Floats
    K: Floats
    noise_covariance: Floats
    sample_time: float


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Parameters that follow the data, after each sample."""

    names: list[str]
    parameters: Floats
    """Samples × parameters."""
    standard_errors: Floats
    """Of the same shape; NaN as long as there are none."""
    prediction: Floats
    """Prediction of each sample by the parameters before it; NaN at the start."""
    error: Floats

    def to_pandas(self) -> pandas.DataFrame:
        """The parameters as a frame of pandas, a row a sample."""
        import pandas

        return pandas.DataFrame(self.parameters, columns=self.names)


@dataclass(frozen=True)
class JointTest:
    """A statistic that follows χ² where there is nothing to find."""

    statistic: float
    degrees_of_freedom: float
    p_value: float

    def passes(self, level: float = 0.99) -> bool:
        """True where the statistic stays in the region that holds it with this probability."""
        return self.p_value >= 1.0 - level


@dataclass(frozen=True, eq=False)
class Whiteness:
    """The correlation of a residual with its own past, at lags 0 to M."""

    mean: float
    correlation: Floats
    bounds: Floats
    joint: JointTest


@dataclass(frozen=True, eq=False)
class Independence:
    """The correlation of a residual with an input, at lags −M to M."""

    correlation: Floats
    bounds: Floats
    dynamics: JointTest
    """The input's present and past: what fails here is dynamics that the model lacks."""
    past: JointTest
    feedback: JointTest
    """The input's future: what fails here is feedback from the output."""


@dataclass(frozen=True, eq=False)
class ResidualReport:
    """Tests of the residuals of a model."""

    whiteness: list[Whiteness]
    """One an output."""
    independence: list[list[Independence]]
    """Each output against each input."""
    joint_whiteness: JointTest
    samples: int
    """Samples that were tested."""
    text: str

    def __repr__(self) -> str:
        return self.text


@dataclass(frozen=True, eq=False)
class Comparison:
    """Several models on the same data."""

    names: list[str]
    fit_percent: list[list[list[float]] | None]
    """Of each model, by experiment and output; none where it cannot be judged."""
    rms_error: list[list[list[float]] | None]
    reasons: list[str | None]
    """Why a model cannot be judged."""
    best: str | None
    """The model whose worst output fits best."""
    text: str

    def __repr__(self) -> str:
        return self.text

    def to_dict(self) -> dict[str, list[list[float]] | None]:
        """The fits by the names of the models."""
        return dict(zip(self.names, self.fit_percent, strict=True))

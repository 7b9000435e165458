"""Figures with matplotlib, or with plotly: what they show is gathered once, so both draw the same numbers.

`axes` are those of matplotlib, or the figure of plotly, to which is added. Without them the figure is new. With matplotlib the axes are returned,
and with plotly the figure.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .errors import ArgumentError

if TYPE_CHECKING:
    from ._dynoid import Fit
    from .results import Bode, Floats, Step

Backend = Literal["matplotlib", "plotly"]


@dataclass(frozen=True)
class Curve:
    """A line over an axis, with its band where it has one."""

    x: Floats
    y: Floats
    name: str
    low: Floats | None = None
    high: Floats | None = None


@dataclass(frozen=True)
class Points:
    """Points of one meaning, each drawn as this sign."""

    x: Floats
    y: Floats
    name: str
    sign: Literal["x", "o", "+"]
    is_data: bool = True


@dataclass(frozen=True)
class Region:
    """An outline: a filled region, or a line to compare with."""

    x: Floats
    y: Floats
    name: str
    is_filled: bool = True


@dataclass(frozen=True)
class Panel:
    """What one pair of axes shows."""

    x_title: str
    y_title: str
    curves: list[Curve] = field(default_factory=list)
    points: list[Points] = field(default_factory=list)
    regions: list[Region] = field(default_factory=list)
    is_log_x: bool = False
    is_log_y: bool = False
    has_equal_axes: bool = False


def bode(response: Bode, axes: Any = None, *, backend: Backend = "matplotlib") -> Any:
    """Magnitude and phase with their bands."""
    name = f"{response.output} / {response.input}"
    magnitude = Curve(response.w, response.magnitude, name, response.low, response.high)
    phase = Curve(response.w, response.phase, name, response.phase_low, response.phase_high)
    panels = [
        Panel("", f"|{name}|", [magnitude], is_log_x=True, is_log_y=True),
        Panel("angular frequency, rad/s", "phase, degrees", [phase], is_log_x=True),
    ]
    return _draw(panels, axes, backend)


def step(response: Step, axes: Any = None, *, backend: Backend = "matplotlib") -> Any:
    """The response with its band."""
    title = f"{response.output} after a step of {response.input}"
    curve = Curve(response.time, response.response, title, response.low, response.high)
    return _draw([Panel("time, s", title, [curve])], axes, backend)


def nyquist(response: Bode, axes: Any = None, *, backend: Backend = "matplotlib") -> Any:
    """The response in the complex plane, with the point −1."""
    name = f"{response.output} / {response.input}"
    curve = Curve(response.response.real, response.response.imag, name)
    critical = Points(np.array([-1.0]), np.array([0.0]), "−1", "+", is_data=False)
    return _draw([Panel(f"real part of {name}", "imaginary part", [curve], [critical], has_equal_axes=True)], axes, backend)


def poles(
    fit: Fit,
    axes: Any = None,
    *,
    level: float = 0.95,
    y: str | int | None = None,
    u: str | int | None = None,
    backend: Backend = "matplotlib",
) -> Any:
    """Poles as crosses and zeros as circles, with the ellipses that hold them with this probability; in discrete time with the unit circle."""
    signs: list[tuple[Literal["x", "o"], str, Any]] = [
        ("x", "poles", fit.poles(level=level, y=y, u=u)),
        ("o", "zeros", fit.zeros(level=level, y=y, u=u)),
    ]
    points, regions = [], []
    for sign, name, roots in signs:
        values = np.array([root.value for root in roots], dtype=complex)
        points.append(Points(values.real, values.imag, name, sign))
        regions += [_ellipse(root, level, f"{level:.0%} region") for root in roots]
    if fit.state_space().sample_time is not None:
        circle = _circle()
        regions.append(Region(circle[0], circle[1], "unit circle", is_filled=False))
    return _draw([Panel("real part", "imaginary part", [], points, regions, has_equal_axes=True)], axes, backend)


def _circle() -> Floats:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    return np.array([np.cos(angle), np.sin(angle)])


def _ellipse(root: Any, level: float, name: str) -> Region:
    """The ellipse of a root: of χ² with two degrees of freedom."""
    reach = np.sqrt(-2.0 * np.log(1.0 - level))
    variances, directions = np.linalg.eigh(root.covariance)
    outline = directions @ (reach * np.sqrt(np.maximum(variances, 0.0))[:, None] * _circle())
    return Region(root.value.real + outline[0], root.value.imag + outline[1], name)


def _draw(panels: list[Panel], axes: Any, backend: Backend) -> Any:
    """Draws panels one below the other."""
    if backend == "matplotlib":
        return _in_matplotlib(panels, axes)
    if backend == "plotly":
        return _in_plotly(panels, axes)
    raise ArgumentError(f'backend="{backend}": choose one of "matplotlib", "plotly"')


def _in_matplotlib(panels: list[Panel], axes: Any) -> Any:
    if axes is None:
        import matplotlib.pyplot as plt

        axes = plt.subplots(len(panels), 1, sharex=True)[1]
    for panel, one in zip(panels, np.atleast_1d(np.asarray(axes, dtype=object)), strict=True):
        for curve in panel.curves:
            one.plot(curve.x, curve.y)
            if curve.low is not None:
                one.fill_between(curve.x, curve.low, curve.high, alpha=0.3)
        for points in panel.points:
            one.plot(points.x, points.y, points.sign, color="C0" if points.is_data else "black", fillstyle="none")
        for region in panel.regions:
            style = {"alpha": 0.3, "color": "C0"} if region.is_filled else {"fill": False, "linestyle": ":"}
            one.fill(region.x, region.y, **style)
        one.set_xlabel(panel.x_title)
        one.set_ylabel(panel.y_title)
        if panel.is_log_x:
            one.set_xscale("log")
        if panel.is_log_y:
            one.set_yscale("log")
        if panel.has_equal_axes:
            one.set_aspect("equal", adjustable="datalim")
    return axes


COLOUR = "#1f77b4"
TINT = "rgba(31, 119, 180, 0.3)"
SYMBOLS = {"x": "x-thin-open", "o": "circle-open", "+": "cross-thin-open"}


def _in_plotly(panels: list[Panel], figure: Any) -> Any:
    from plotly.graph_objects import Scatter
    from plotly.subplots import make_subplots

    if figure is None:
        figure = make_subplots(len(panels), 1, shared_xaxes=True)
    for row, panel in enumerate(panels, 1):
        place = {"row": row, "col": 1}
        for curve in panel.curves:
            if curve.low is not None and curve.high is not None:
                band = {"x": np.concatenate([curve.x, curve.x[::-1]]), "y": np.concatenate([curve.low, curve.high[::-1]])}
                figure.add_trace(_outline(Scatter, band, f"band of {curve.name}", is_filled=True), **place)
            line = Scatter(x=curve.x, y=curve.y, name=curve.name, mode="lines", line={"color": COLOUR}, showlegend=row == 1)
            figure.add_trace(line, **place)
        for region in panel.regions:
            figure.add_trace(_outline(Scatter, {"x": region.x, "y": region.y}, region.name, region.is_filled), **place)
        for points in panel.points:
            colour = COLOUR if points.is_data else "black"
            marker = {"symbol": SYMBOLS[points.sign], "size": 10, "color": colour, "line": {"width": 2, "color": colour}}
            figure.add_trace(Scatter(x=points.x, y=points.y, name=points.name, mode="markers", marker=marker), **place)
        figure.update_xaxes(title_text=panel.x_title, type="log" if panel.is_log_x else "linear", **place)
        figure.update_yaxes(title_text=panel.y_title, type="log" if panel.is_log_y else "linear", **place)
        if panel.has_equal_axes:
            figure.update_yaxes(scaleanchor="x", **place)
    return figure


def _outline(scatter: Any, points: dict[str, Any], name: str, is_filled: bool) -> Any:
    """A closed line, filled, or dotted to compare with."""
    style = {"fill": "toself", "fillcolor": TINT, "line": {"width": 0}} if is_filled else {"line": {"color": "grey", "dash": "dot"}}
    return scatter(**points, name=name, mode="lines", hoverinfo="skip", showlegend=False, **style)

"""Figures: both backends draw the same numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import dynoid
import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import plotly.graph_objects
import pytest

PLOTS: dict[str, Callable[[dynoid.Fit, dict[str, Any]], Any]] = {
    "bode": lambda fit, how: fit.bode().plot(**how),
    "nyquist": lambda fit, how: fit.bode().nyquist(**how),
    "step": lambda fit, how: fit.step().plot(**how),
    "poles": lambda fit, how: dynoid.plots.poles(fit, **how),
}


def of_matplotlib(axes: Any) -> list[np.ndarray]:
    """Points of the lines, and outlines of the areas, without the closing point that matplotlib adds."""
    found = []
    for one in np.atleast_1d(np.asarray(axes, dtype=object)):
        found += [np.column_stack(line.get_data()) for line in one.lines]
        found += [patch.get_xy() for patch in one.patches]
        found += [area.get_paths()[0].vertices for area in one.collections]
    return found


def corners(points: np.ndarray) -> set[tuple[float, float]]:
    return {(round(float(x), 9), round(float(y), 9)) for x, y in points}


@pytest.mark.parametrize("plot", PLOTS)
def test_exact_both_backends_draw_the_same_numbers(plot: str, fit: dynoid.Fit) -> None:
    matplotlib.use("Agg")
    figure = PLOTS[plot](fit, {"backend": "plotly"})
    assert isinstance(figure, plotly.graph_objects.Figure)
    theirs = [corners(np.column_stack([trace.x, trace.y])) for trace in figure.data]
    ours = [corners(points) for points in of_matplotlib(PLOTS[plot](fit, {}))]
    assert len(theirs) == len(ours) and all(one in ours or any(one <= other for other in ours) for one in theirs)
    plt.close("all")


def test_exact_traces_of_a_bode_diagram(fit: dynoid.Fit) -> None:
    response = fit.bode()
    band, line, phase_band, phase = response.plot(backend="plotly").data
    assert np.array_equal(line.x, response.w) and np.array_equal(line.y, response.magnitude)
    assert np.array_equal(band.y, np.concatenate([response.low, response.high[::-1]])) and band.fill == "toself"
    assert np.array_equal(phase.y, response.phase) and len(phase_band.y) == 2 * len(response.w)


def test_exact_a_figure_takes_several_plots(fit: dynoid.Fit) -> None:
    figure = fit.step().plot(backend="plotly")
    assert fit.step().plot(figure, backend="plotly") is figure and len(figure.data) == 4
    assert figure.layout.xaxis.title.text == "time, s" and figure.layout.yaxis.title.text == "N after a step of T"


def test_regress_an_unknown_backend_is_refused(fit: dynoid.Fit) -> None:
    with pytest.raises(dynoid.errors.ArgumentError, match='backend="bokeh": choose one of "matplotlib", "plotly"'):
        fit.step().plot(backend="bokeh")  # type: ignore[arg-type]

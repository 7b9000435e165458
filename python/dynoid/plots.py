"""Figures with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._dynoid import Fit
    from .results import Bode, Step


def bode(response: Bode, axes: Any = None) -> Any:
    """Magnitude and phase with their bands."""
    axes = _axes(axes, 2)
    magnitude, phase = axes
    magnitude.loglog(response.w, response.magnitude)
    magnitude.fill_between(response.w, response.low, response.high, alpha=0.3)
    magnitude.set_ylabel(f"|{response.output} / {response.input}|")
    phase.semilogx(response.w, response.phase)
    phase.fill_between(response.w, response.phase_low, response.phase_high, alpha=0.3)
    phase.set_ylabel("phase, degrees")
    phase.set_xlabel("angular frequency, rad/s")
    return axes


def step(response: Step, axes: Any = None) -> Any:
    """The response with its band."""
    axes = _axes(axes)
    axes.plot(response.time, response.response)
    axes.fill_between(response.time, response.low, response.high, alpha=0.3)
    axes.set_xlabel("time, s")
    axes.set_ylabel(f"{response.output} after a step of {response.input}")
    return axes


def nyquist(response: Bode, axes: Any = None) -> Any:
    """The response in the complex plane, with the point −1."""
    axes = _axes(axes)
    axes.plot(response.response.real, response.response.imag)
    axes.plot(-1.0, 0.0, "+", color="black")
    axes.set_xlabel(f"real part of {response.output} / {response.input}")
    axes.set_ylabel("imaginary part")
    axes.set_aspect("equal", adjustable="datalim")
    return axes


def poles(fit: Fit, axes: Any = None, *, level: float = 0.95, y: str | int | None = None, u: str | int | None = None) -> Any:
    """Poles as crosses and zeros as circles, with the ellipses that hold them with this probability; in discrete time with the unit circle."""
    from matplotlib.patches import Circle, Ellipse

    axes = _axes(axes)
    found = {"x": fit.poles(level=level, y=y, u=u), "o": fit.zeros(level=level, y=y, u=u)}
    # The quantile of χ² with two degrees of freedom.
    reach = np.sqrt(-2.0 * np.log(1.0 - level))
    for marker, roots in found.items():
        values = np.array([root.value for root in roots])
        axes.plot(values.real, values.imag, marker, color="C0", fillstyle="none")
        for root in roots:
            variances, directions = np.linalg.eigh(root.covariance)
            width, height = 2.0 * reach * np.sqrt(np.maximum(variances, 0.0))
            angle = np.degrees(np.arctan2(directions[1, 0], directions[0, 0]))
            axes.add_patch(Ellipse((root.value.real, root.value.imag), width, height, angle=angle, alpha=0.3))
    if fit.state_space().sample_time is not None:
        axes.add_patch(Circle((0.0, 0.0), 1.0, fill=False, linestyle=":"))
    axes.set_xlabel("real part")
    axes.set_ylabel("imaginary part")
    axes.set_aspect("equal", adjustable="datalim")
    return axes


def _axes(given: Any, rows: int = 1) -> Any:
    """The axes that were given, or else new ones, one below the other."""
    if given is not None:
        return given
    import matplotlib.pyplot as plt

    return plt.subplots(rows, 1, sharex=True)[1]

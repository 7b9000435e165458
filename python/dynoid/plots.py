"""Figures with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .results import Bode, Step


def bode(response: Bode, axes: Any = None) -> Any:
    """Magnitude and phase with their bands."""
    if axes is None:
        import matplotlib.pyplot as plt

        _, axes = plt.subplots(2, 1, sharex=True)
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
    if axes is None:
        import matplotlib.pyplot as plt

        _, axes = plt.subplots()
    axes.plot(response.time, response.response)
    axes.fill_between(response.time, response.low, response.high, alpha=0.3)
    axes.set_xlabel("time, s")
    axes.set_ylabel(f"{response.output} after a step of {response.input}")
    return axes

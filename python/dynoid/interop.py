"""Estimates in other packages, and in notebooks."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import ArgumentError

if TYPE_CHECKING:
    from ._dynoid import Fit


def to_control(fit: Fit, pade: int | None) -> Any:
    """The system of python-control."""
    import control

    system = fit.state_space()
    if not system.inputs:
        raise ArgumentError("the model has no input, and python-control has no such systems; `innovations()` gives the matrices of its noise model")
    delays = np.unique(system.delays)
    channels = {"inputs": system.inputs, "outputs": system.outputs}
    dt = 0 if system.sample_time is None else system.sample_time
    without = control.ss(system.A, system.B, system.C, system.D, dt, **channels)
    if not np.any(delays):
        return without
    if pade is None:
        raise ArgumentError("python-control has no delays in continuous time; give the order of an approximation: to_control(pade=3)")
    if len(delays) > 1:
        raise ArgumentError("the channels have different delays; convert one channel at a time")
    numerator, denominator = control.pade(float(delays[0]), pade)
    delay = control.append(*[control.ss(control.tf(numerator, denominator))] * len(system.inputs))
    return control.ss(control.series(delay, without), **channels)


def to_scipy(fit: Fit) -> Any:
    """The system of scipy.signal."""
    import scipy.signal

    system = fit.state_space()
    if np.any(system.delays):
        raise ArgumentError("scipy.signal has no delays in continuous time; `state_space()` gives matrices and delays apart")
    if system.sample_time is None:
        return scipy.signal.StateSpace(system.A, system.B, system.C, system.D)
    return scipy.signal.StateSpace(system.A, system.B, system.C, system.D, dt=system.sample_time)


def fit_to_html(fit: Fit) -> str:
    """The estimate as a notebook shows it: its equations and facts, and its parameters with intervals."""
    table = fit.table()
    rows = zip(table.name, table.value, table.standard_error, table.low, table.high, strict=True)
    cells = "".join(
        f"<tr><td>{html.escape(name)}</td>" + "".join(f"<td>{number:.6g}</td>" for number in numbers) + "</tr>"
        for name, *numbers in rows
    )
    head = "".join(f"<th>{title}</th>" for title in ("parameter", "value", "standard error", "95 % from", "to"))
    return f"<pre>{html.escape(repr(fit))}</pre><table><thead><tr>{head}</tr></thead><tbody>{cells}</tbody></table>"

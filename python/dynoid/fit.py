"""Estimators of linear models, with the orders of Ljung's book.

`na`, `nb`, `nc`, `nd` and `nf` count coefficients, and `nk` the samples of delay. Each of `nb`, `nf` and `nk` is one number for all inputs, or a
list with one for each.
"""

from __future__ import annotations

import json
import os
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from . import _dynoid
from ._dynoid import Dataset, Fit
from .errors import ArgumentError

PerInput = int | Sequence[int]
Delay = float | tuple[float, float]
Initial = Literal["estimated", "zero"]
Focus = Literal["prediction", "simulation"]
Weighting = Literal["auto", "cva", "n4sid", "moesp", "ssarx"]


def arx(data: Dataset, *, na: int, nb: PerInput, nk: PerInput = 1) -> Fit:
    """ARX by least squares: A y = B u + e."""
    _check_orders(na=na, nb=nb, nk=nk)
    return _dynoid.arx(data, na, nb, nk, False)


def iv4(data: Dataset, *, na: int, nb: PerInput, nk: PerInput = 1) -> Fit:
    """ARX by instrumental variables in four steps: right under coloured noise, unless the input follows the output (closed loop)."""
    _check_orders(na=na, nb=nb, nk=nk)
    return _dynoid.arx(data, na, nb, nk, True)


def armax(
    data: Dataset,
    *,
    na: int,
    nb: PerInput = 0,
    nc: int,
    nk: PerInput = 1,
    focus: Focus = "prediction",
    initial: Initial = "estimated",
    band: tuple[float, float] | None = None,
    hold: Mapping[str, float] | None = None,
) -> Fit:
    """ARMAX: A y = B u + C e. Without inputs it is ARMA.

    `focus` says whose errors are made small, `band` from which to which frequency in Hz they count, and `hold` which coefficients are known.
    """
    _check_orders(na=na, nb=nb, nc=nc, nk=nk)
    return _dynoid.polynomial(data, "ARMAX", na, nb, nc, 0, 0, nk, focus, initial, band, dict(hold or {}))


def oe(
    data: Dataset,
    *,
    nb: PerInput,
    nf: PerInput,
    nk: PerInput = 1,
    initial: Initial = "estimated",
    band: tuple[float, float] | None = None,
    hold: Mapping[str, float] | None = None,
) -> Fit:
    """Output error: y = B/F u + e."""
    _check_orders(nb=nb, nf=nf, nk=nk)
    return _dynoid.polynomial(data, "output error", 0, nb, 0, 0, nf, nk, "prediction", initial, band, dict(hold or {}))


def bj(
    data: Dataset,
    *,
    nb: PerInput,
    nc: int,
    nd: int,
    nf: PerInput,
    nk: PerInput = 1,
    focus: Focus = "prediction",
    initial: Initial = "estimated",
    band: tuple[float, float] | None = None,
    hold: Mapping[str, float] | None = None,
) -> Fit:
    """Box–Jenkins: y = B/F u + C/D e."""
    _check_orders(nb=nb, nc=nc, nd=nd, nf=nf, nk=nk)
    return _dynoid.polynomial(data, "Box–Jenkins", 0, nb, nc, nd, nf, nk, focus, initial, band, dict(hold or {}))


def polynomial(
    data: Dataset,
    *,
    na: int = 0,
    nb: PerInput = 0,
    nc: int = 0,
    nd: int = 0,
    nf: PerInput = 0,
    nk: PerInput = 1,
    focus: Focus = "prediction",
    initial: Initial = "estimated",
    band: tuple[float, float] | None = None,
    hold: Mapping[str, float] | None = None,
) -> Fit:
    """All polynomials: A y = B/F u + C/D e."""
    _check_orders(na=na, nb=nb, nc=nc, nd=nd, nf=nf, nk=nk)
    return _dynoid.polynomial(data, "polynomial", na, nb, nc, nd, nf, nk, focus, initial, band, dict(hold or {}))


def tf(
    data: Dataset,
    *,
    poles: PerInput,
    zeros: PerInput | None = None,
    delay: Delay | Sequence[Delay] | None = None,
    integrators: int = 0,
    offset: bool = False,
    unstable: bool = False,
    initial: Initial = "estimated",
    method: Literal["output-error", "instruments"] = "output-error",
) -> Fit:
    """Transfer functions in continuous time, with so many poles and zeros. Without a number of zeros there is one less than there are poles.

    `delay` is in seconds: a number if it is known, two numbers between which it is searched, or a list with one of these for each input.
    `offset` estimates a level of the outputs besides, `fit.offsets`. Predictions and comparisons with data that have their mean contain it.
    """
    if zeros is None:
        zeros = max(poles - 1, 0) if isinstance(poles, int) else [max(order - 1, 0) for order in poles]
    _check_orders(poles=poles, zeros=zeros)
    return _dynoid.transfer_function(
        data, poles, zeros, _ranges(delay, len(data.inputs)), integrators, offset, unstable, initial, method
    )


def process(
    data: Dataset,
    structure: str,
    *,
    delay: Delay | Sequence[Delay] | None = None,
    offset: bool = False,
    hold: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
) -> Fit:
    """Process models such as `"P1D"`: one pole and a delay; `Z` adds a zero, `I` an integrator, `U` a complex pair.

    `offset` estimates a level of the outputs besides, `fit.offsets`. Predictions and comparisons with data that have their mean contain it.
    """
    if delay is not None and "D" not in structure:
        raise ArgumentError(f'delay: the structure "{structure}" has no delay; add the letter D')
    delays = _ranges(delay, len(data.inputs))
    return _dynoid.process(data, structure, delays, offset, dict(hold or {}), dict(bounds or {}))


def n4sid(
    data: Dataset,
    *,
    order: int | None = None,
    weighting: Weighting = "auto",
    feedthrough: bool = False,
    focus: Focus = "prediction",
) -> Fit:
    """State space by subspaces. Without an order, the data choose one."""
    return _dynoid.subspace(data, order, weighting, feedthrough, focus == "simulation")


def ss(
    data: Dataset,
    *,
    order: int | None = None,
    weighting: Weighting = "auto",
    feedthrough: bool = False,
    focus: Focus = "prediction",
) -> Fit:
    """State space by prediction error, from a start by subspaces. Without an order, the data choose one."""
    return _dynoid.state_space(data, order, weighting, feedthrough, focus == "simulation")


def greybox(
    data: Dataset,
    structure: Mapping[str, Any] | str | os.PathLike[str],
    *,
    initial: Initial = "estimated",
    starts: int = 0,
) -> Fit:
    """A grey box: state space whose entries are formulas of physical parameters.

    `structure` is what `dynoid fit greybox --help` shows, as a dictionary or as a TOML file. `starts` counts further starts of the search.
    """
    if not isinstance(structure, Mapping):
        structure = tomllib.loads(Path(structure).read_text(encoding="utf-8"))
    return _dynoid.grey_box(data, json.dumps(structure), initial, starts)


def _check_orders(**orders: PerInput) -> None:
    """Refuses numbers below zero."""
    for name, given in orders.items():
        least = int(np.min(np.asarray(given, dtype=np.int64), initial=0))
        if least < 0:
            remedy = "shift the input by hand if the output comes first" if name == "nk" else "it counts coefficients"
            raise ArgumentError(f"{name}={given}: {least} is below zero; give 0 or more: {remedy}")


def _ranges(delay: Delay | Sequence[Delay] | None, inputs: int) -> list[tuple[float, float]]:
    """A range of delays for each input; none where no delay is given."""
    if delay is None:
        return []
    each: Sequence[Delay] = delay if isinstance(delay, list) else [delay] * inputs  # type: ignore[list-item]
    return [(float(one[0]), float(one[1])) if isinstance(one, tuple) else (float(one), float(one)) for one in each]

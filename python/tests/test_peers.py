"""Estimates and responses against python-control, scipy.signal, statsmodels and SIPPY on the same data."""

from __future__ import annotations

from typing import Any

import control
import dynoid
import matplotlib
import numpy as np
import pytest
from conftest import simulated
from scipy import signal
from statsmodels.regression.linear_model import OLS
from statsmodels.tsa.ar_model import AutoReg
from statsmodels.tsa.arima.model import ARIMA

matplotlib.use("Agg")
from sippy_unipi import system_identification  # noqa: E402

TRUTH = {"a1": -1.5, "a2": 0.7, "b1": 1.0, "b2": 0.5}


def series(b: list[float], a: list[float], samples: int, seed: int) -> np.ndarray:
    """White noise through a filter, after its start."""
    e = np.random.default_rng(seed).standard_normal(samples + 200)
    return signal.lfilter(b, a, e)[200:]


def coloured(samples: int, seed: int) -> dynoid.Dataset:
    """The system of `simulated` with the noise (1 + 0.6 q⁻¹)/A."""
    random = np.random.default_rng(seed)
    u, e = random.standard_normal(samples), 0.5 * random.standard_normal(samples)
    a = [1.0, -1.5, 0.7]
    y = signal.lfilter([0.0, 1.0, 0.5], a, u) + signal.lfilter([1.0, 0.6], a, e)
    return dynoid.Dataset(y, u, sample_time=0.1)


def test_ref_autoregression_of_statsmodels() -> None:
    y = series([1.0], [1.0, -1.2, 0.5], 1500, 1)
    fit = dynoid.fit.arx(dynoid.Dataset(y, sample_time=1.0), na=2, nb=0)
    theirs = AutoReg(y, lags=2, trend="n").fit()
    assert list(fit.parameters.values()) == pytest.approx(-theirs.params, abs=1e-9)
    assert list(fit.standard_errors.values()) == pytest.approx(theirs.bse, rel=0.01)
    assert fit.noise_covariance[0, 0] == pytest.approx(theirs.sigma2, rel=0.01)


@pytest.mark.parametrize(("b", "a"), [([1.0, 0.4], [1.0, -1.2, 0.5]), ([1.0, -0.5, 0.3], [1.0, 0.75])])
def test_ref_arma_of_statsmodels(b: list[float], a: list[float]) -> None:
    y = series(b, a, 1500, 2)
    na, nc = len(a) - 1, len(b) - 1
    fit = dynoid.fit.armax(dynoid.Dataset(y, sample_time=1.0), na=na, nc=nc)
    theirs = ARIMA(y, order=(na, 0, nc), trend="n").fit(cov_type="oim")
    signs = np.array([-1.0] * na + [1.0] * nc)
    ours, errors = np.array(list(fit.parameters.values())), np.array(list(fit.standard_errors.values()))
    # Both estimates have one limit, so that their difference is a small part of the standard error.
    assert np.all(np.abs(ours - signs * theirs.params[:-1]) < 0.1 * errors)
    assert errors == pytest.approx(theirs.bse[:-1], rel=0.1)
    assert fit.noise_covariance[0, 0] == pytest.approx(theirs.params[-1], rel=0.01)


def test_ref_arx_and_intervals_of_ordinary_least_squares() -> None:
    data = simulated(800, 0.5, 3)
    u, y = data.u[:, 0], data.y[:, 0]
    theirs = OLS(y[2:], np.column_stack([-y[1:-1], -y[:-2], u[1:-1], u[:-2]])).fit()
    fit = dynoid.fit.arx(data, na=2, nb=2)
    assert list(fit.parameters.values()) == pytest.approx(theirs.params, abs=1e-9)
    assert list(fit.standard_errors.values()) == pytest.approx(theirs.bse, rel=1e-6)
    assert np.array(list(fit.intervals(0.9).values())) == pytest.approx(theirs.conf_int(0.1), rel=2e-3)


def test_ref_responses_of_scipy_in_discrete_time() -> None:
    fit = dynoid.fit.oe(simulated(800, 0.1, 4), nb=2, nf=2)
    system = signal.TransferFunction(*fit.transfer_function(), dt=0.1)
    w = np.linspace(0.5, 30.0, 60)
    _, decibels, degrees = system.bode(w * 0.1)
    bode = fit.bode(w)
    assert 20 * np.log10(bode.magnitude) == pytest.approx(decibels, abs=1e-6)
    turns = (bode.phase - degrees) / 360
    assert turns == pytest.approx(np.round(turns), abs=1e-8)
    time, (expected,) = system.step(n=50)
    assert fit.step(time).response == pytest.approx(expected[:, 0], abs=1e-8)


def test_ref_responses_of_scipy_in_continuous_time() -> None:
    data = simulated(800, 0.1, 5)
    fit = dynoid.fit.tf(data, poles=2, zeros=1)
    system = signal.TransferFunction(*fit.transfer_function())
    w = np.logspace(-1, 1.5, 60)
    _, decibels, degrees = system.bode(w)
    bode = fit.bode(w)
    assert 20 * np.log10(bode.magnitude) == pytest.approx(decibels, abs=1e-6)
    assert bode.phase == pytest.approx(degrees, abs=1e-6)
    time = np.linspace(0.0, 4.0, 80)
    assert fit.step(time).response == pytest.approx(signal.step(system, T=time)[1], abs=1e-6)
    _, held, _ = signal.lsim(system, data.u[:, 0], data.time, interp=False)
    assert fit.simulate(data, initial="zero").y[:, 0] == pytest.approx(held, abs=1e-6)


def test_ref_margins_poles_and_zeros_of_python_control() -> None:
    fit = dynoid.fit.armax(coloured(2000, 6), na=2, nb=2, nc=1)
    system = fit.to_control()
    assert np.sort_complex([pole.value for pole in fit.poles()]) == pytest.approx(np.sort_complex(control.poles(system)), abs=1e-9)
    assert [zero.value for zero in fit.zeros()] == pytest.approx(control.zeros(system), abs=1e-9)
    frequencies, dampings, _ = control.damp(system, doprint=False)
    assert [pole.natural_frequency for pole in fit.poles()] == pytest.approx(frequencies, rel=1e-9)
    assert [pole.damping for pole in fit.poles()] == pytest.approx(dampings, rel=1e-9)
    gain_margin, phase_margin, phase_crossing, gain_crossing = control.margin(system)
    bode = fit.bode([phase_crossing, gain_crossing])
    assert bode.magnitude == pytest.approx([1.0 / gain_margin, 1.0], rel=1e-6)
    turns = (bode.phase + 180.0 - [0.0, phase_margin]) / 360.0
    assert turns == pytest.approx(np.round(turns), abs=1e-6)


def test_ref_several_channels_of_python_control() -> None:
    random = np.random.default_rng(7)
    u, e = random.standard_normal((1500, 2)), 0.1 * random.standard_normal((1500, 2))
    y = np.zeros((1500, 2))
    for t in range(1, 1500):
        y[t] = np.array([[0.8, 0.1], [0.0, 0.5]]) @ y[t - 1] + np.array([[1.0, 0.0], [0.3, 2.0]]) @ u[t - 1] + e[t]
    fit = dynoid.fit.ss(dynoid.Dataset(y, u, sample_time=0.5), order=2)
    system = fit.to_control()
    w = np.array([0.1, 1.0, 4.0])
    theirs = control.frequency_response(system, w)
    steps = control.step_response(system, T=np.arange(20) * 0.5).outputs
    for output in range(2):
        for source in range(2):
            ours = fit.bode(w, y=output, u=source)
            assert ours.response == pytest.approx(theirs.complex[output, source], rel=1e-6)
            assert fit.step(np.arange(20) * 0.5, y=output, u=source).response == pytest.approx(steps[output, source], abs=1e-8)


def errors_ahead(b: Any, a: Any, c: Any, data: dynoid.Dataset) -> float:
    """The mean squared prediction error of A y = B u + C e one step ahead, after the start."""
    errors = signal.lfilter(a, c, data.y[:, 0]) - signal.lfilter(b, c, data.u[:, 0])
    return float(np.mean(errors[100:] ** 2))


def errors_of_states(model: Any, data: dynoid.Dataset) -> float:
    """The same of a model in innovations form."""
    x, errors = np.zeros(len(model.A)), []
    for u, y in zip(data.u, data.y, strict=True):
        errors.append((y - model.C @ x - model.D @ u)[0])
        x = model.A @ x + model.B @ u + model.K @ y - model.K @ (model.C @ x + model.D @ u)
    return float(np.mean(np.square(errors[100:])))


def polynomials(fit: dynoid.Fit) -> tuple[list[float], list[float], list[float]]:
    """B, A and C."""
    found = {first: [value for name, value in fit.parameters.items() if name[0] == first] for first in "abc"}
    return [0.0, *found["b"]], [1.0, *found["a"]], [1.0, *found["c"]]


def theirs_of_sippy(data: dynoid.Dataset, method: str, **options: Any) -> Any:
    return system_identification(data.y[:, 0], data.u[:, 0], method, tsample=0.1, **options)


def holds_truth(fit: dynoid.Fit, truth: dict[str, float]) -> bool:
    intervals = fit.intervals(0.999)
    return all(intervals[name][0] < value < intervals[name][1] for name, value in truth.items())


def test_ref_arx_of_sippy() -> None:
    estimation, validation = simulated(3000, 0.5, 8).split(0.5)
    theirs = theirs_of_sippy(estimation, "ARX", ARX_orders=[2, 2, 0])
    fit = dynoid.fit.arx(estimation, na=2, nb=2)
    numerator, denominator = theirs.G.num[0][0], theirs.G.den[0][0]
    assert list(fit.parameters.values()) == pytest.approx([*denominator[1:], *numerator], abs=1e-6)
    loss = errors_ahead([0.0, *numerator], denominator, [1.0], validation)
    assert errors_ahead(*polynomials(fit), validation) < 1.01 * loss
    assert holds_truth(fit, TRUTH)


def test_ref_armax_of_sippy() -> None:
    estimation, validation = coloured(3000, 9).split(0.5)
    theirs = theirs_of_sippy(estimation, "ARMAX", ARMAX_orders=[2, 2, 1, 0])
    fit = dynoid.fit.armax(estimation, na=2, nb=2, nc=1)
    numerator, denominator, noise = theirs.G.num[0][0], theirs.G.den[0][0], theirs.H.num[0][0][:2]
    loss = errors_ahead([0.0, *numerator], denominator, noise, validation)
    assert errors_ahead(*polynomials(fit), validation) < 1.01 * loss
    assert loss == pytest.approx(0.25, rel=0.2)
    assert holds_truth(fit, TRUTH | {"c1": 0.6})


def test_ref_subspaces_of_sippy() -> None:
    estimation, validation = coloured(2000, 10).split(0.5)
    theirs = errors_of_states(theirs_of_sippy(estimation, "N4SID", SS_fixed_order=2), validation)
    assert errors_of_states(dynoid.fit.n4sid(estimation, order=2).innovations(), validation) < 1.01 * theirs
    fit = dynoid.fit.ss(estimation, order=2)
    assert errors_of_states(fit.innovations(), validation) == pytest.approx(0.25, rel=0.2)
    w = np.array([0.5, 2.0, 5.0, 12.0])
    z = np.exp(0.1j * w)
    gain, bode = np.abs((z + 0.5) / (z**2 - 1.5 * z + 0.7)), fit.bode(w, level=0.999)
    assert np.all((bode.low < gain) & (gain < bode.high))

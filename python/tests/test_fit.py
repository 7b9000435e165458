"""Estimates: their numbers against numpy, scipy and python-control, and what can be done with them."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path

import control
import dynoid
import numpy as np
import pytest
from conftest import simulated
from scipy import signal

TRUTH = {"a1": -1.5, "a2": 0.7, "b1": 1.0, "b2": 0.5}


def test_exact_arx_without_noise() -> None:
    fit = dynoid.fit.arx(simulated(500, 0.0, 2), na=2, nb=2, nk=1)
    assert list(fit.parameters.values()) == pytest.approx(list(TRUTH.values()), abs=1e-9)


def test_ref_arx_is_least_squares_of_numpy(data: dynoid.Dataset, fit: dynoid.Fit) -> None:
    u, y = data.u[:, 0], data.y[:, 0]
    regressor = np.column_stack([-y[1:-1], -y[:-2], u[1:-1], u[:-2]])
    theta, *_ = np.linalg.lstsq(regressor, y[2:], rcond=None)
    assert list(fit.parameters.values()) == pytest.approx(theta, abs=1e-10)
    errors = y[2:] - regressor @ theta
    variance = errors @ errors / (len(errors) - 4)
    assert fit.noise_covariance == pytest.approx(np.array([[variance]]), rel=1e-9)
    assert fit.covariance == pytest.approx(variance * np.linalg.inv(regressor.T @ regressor), rel=1e-6, abs=1e-14)


def test_exact_intervals_hold_the_truth(fit: dynoid.Fit) -> None:
    intervals = fit.intervals(0.9999)
    assert len(intervals) == len(TRUTH)
    assert all(low < truth < high for (low, high), truth in zip(intervals.values(), TRUTH.values(), strict=True))
    table = fit.table(0.9999)
    assert table.name == list(intervals) and list(zip(table.low, table.high, strict=True)) == list(intervals.values())


@pytest.mark.parametrize(
    "estimate",
    [
        lambda d: dynoid.fit.arx(d, na=2, nb=2),
        lambda d: dynoid.fit.iv4(d, na=2, nb=2),
        lambda d: dynoid.fit.armax(d, na=2, nb=2, nc=1),
        lambda d: dynoid.fit.oe(d, nb=2, nf=2),
        lambda d: dynoid.fit.bj(d, nb=2, nc=0, nd=2, nf=2),
        lambda d: dynoid.fit.polynomial(d, na=2, nb=2),
        lambda d: dynoid.fit.n4sid(d, order=2),
        lambda d: dynoid.fit.ss(d, order=2),
    ],
)
def test_ref_every_estimator_finds_the_response(estimate, data: dynoid.Dataset) -> None:
    w = np.array([0.5, 2.0, 5.0, 12.0])
    z = np.exp(1j * w * 0.1)
    gain = np.abs((z + 0.5) / (z**2 - 1.5 * z + 0.7))
    found = estimate(data).bode(w, level=0.999)
    assert found.magnitude == pytest.approx(gain, rel=0.05)
    assert np.all(found.low <= found.magnitude) and np.all(found.magnitude <= found.high)


def test_ref_continuous_transfer_function_against_scipy() -> None:
    random = np.random.default_rng(4)
    time = np.arange(1000) * 0.05
    u = np.repeat(random.standard_normal(100), 10)
    # Held inputs: the discrete system is exact.
    a, b, c, d, _ = signal.cont2discrete(signal.tf2ss([2.0], [1.0, 0.8, 4.0]), 0.05, method="zoh")
    _, y, _ = signal.dlsim((a, b, c, d, 0.05), u)
    data = dynoid.Dataset(y[:, 0] + 1e-4 * random.standard_normal(1000), u, sample_time=0.05)
    fit = dynoid.fit.tf(data, poles=2, zeros=0)
    numerator, denominator = fit.transfer_function()
    assert numerator == pytest.approx([2.0], rel=1e-3) and denominator == pytest.approx([1.0, 0.8, 4.0], rel=1e-3)
    system = fit.to_scipy()
    _, expected = signal.step(system, T=time[:100])
    assert fit.step(time[:100]).response == pytest.approx(expected, abs=1e-6)
    pole = fit.poles()[0]
    assert pole.natural_frequency == pytest.approx(2.0, rel=1e-3) and pole.damping == pytest.approx(0.2, rel=1e-2)
    assert pole.damping_interval is not None and pole.damping_interval[0] < 0.2 < pole.damping_interval[1]


def test_ref_several_inputs_and_outputs_in_python_control() -> None:
    random = np.random.default_rng(5)
    u = random.standard_normal((1500, 2))
    y = np.zeros((1500, 2))
    for t in range(1, 1500):
        y[t, 0] = 0.8 * y[t - 1, 0] + u[t - 1, 0] + 0.01 * random.standard_normal()
        y[t, 1] = 0.5 * y[t - 1, 1] + 2 * u[t - 1, 1] + 0.3 * u[t - 1, 0] + 0.01 * random.standard_normal()
    data = dynoid.Dataset({"y1": y[:, 0], "y2": y[:, 1]}, {"u1": u[:, 0], "u2": u[:, 1]}, sample_time=1.0)
    fit = dynoid.fit.n4sid(data, order=2)
    system = fit.to_control()
    assert (system.ninputs, system.noutputs, system.dt) == (2, 2, 1.0)
    assert np.sort(np.real(control.poles(system))) == pytest.approx([0.5, 0.8], abs=5e-3)
    assert control.dcgain(system) == pytest.approx(np.array([[5.0, 0.0], [0.6, 4.0]]), abs=0.05)
    with pytest.raises(dynoid.errors.ArgumentError, match="several outputs; name one of y1, y2"):
        fit.bode()
    gain = fit.bode([1e-6], y="y2", u="u2").magnitude
    assert gain == pytest.approx([4.0], abs=0.05)


def test_exact_prediction_and_residuals_add_up(data: dynoid.Dataset, fit: dynoid.Fit) -> None:
    predicted, residuals = fit.predict(data), fit.residuals(data)
    assert predicted.y + residuals.y == pytest.approx(data.y, abs=1e-9)
    assert np.std(residuals.y[2:]) == pytest.approx(0.1, rel=0.1)
    simulated_y = fit.simulate(data).y
    judged = dynoid.compare([fit], data, names=["arx"])
    error = np.linalg.norm(data.y - simulated_y) / np.linalg.norm(data.y - data.y.mean())
    assert judged.to_dict()["arx"] == [[pytest.approx(100 * (1 - error))]] and judged.best == "arx"


def test_ref_residual_tests_tell_a_right_model_from_a_wrong_one(data: dynoid.Dataset, fit: dynoid.Fit) -> None:
    right = fit.test_residuals(data, own=True)
    assert right.joint_whiteness.passes(0.999) and right.independence[0][0].dynamics.passes(0.999)
    wrong = dynoid.fit.oe(data, nb=1, nf=1).test_residuals(data, own=True)
    assert not wrong.independence[0][0].dynamics.passes(0.999)
    assert "rejected" in repr(wrong)


def test_exact_copies_are_the_same(data: dynoid.Dataset, fit: dynoid.Fit, tmp_path: Path) -> None:
    transfer = dynoid.fit.tf(data, poles=1, zeros=0, offset=True)
    for one in [fit, transfer]:
        for other in [pickle.loads(pickle.dumps(one)), copy.copy(one), copy.deepcopy(one)]:
            assert repr(other) == repr(one)
            assert np.array_equal(other.covariance, one.covariance)
            assert other.test_residuals(data, own=True).text == one.test_residuals(data, own=True).text
    fit.save(tmp_path / "model.json")
    assert dynoid.load(tmp_path / "model.json").parameters == fit.parameters
    assert np.array_equal(pickle.loads(pickle.dumps(fit.bode())).low, fit.bode().low)


def test_snap_an_estimate_shows_its_equations(fit: dynoid.Fit) -> None:
    assert repr(fit).startswith("ARX model in discrete time, sample time 0.1 s\n  A(q) y(t) = B(q) u(t) + e(t)")
    shown = fit._repr_html_()
    assert "<th>standard error</th>" in shown and "A(q) y(t)" in shown


def test_regress_errors_have_fields(data: dynoid.Dataset) -> None:
    short, _ = data.split(0.002)
    with pytest.raises(dynoid.errors.EstimateError) as caught:
        dynoid.fit.arx(short, na=2, nb=2)
    assert caught.value.kind == "TooFewSamples" and caught.value.fields["parameters"] == 4
    other = pickle.loads(pickle.dumps(caught.value))
    assert type(other) is dynoid.errors.EstimateError and other.fields == caught.value.fields
    with pytest.raises(ValueError, match="nb: 2 values for 1 inputs"):
        dynoid.fit.arx(data, na=2, nb=[1, 2])
    with pytest.raises(dynoid.errors.ArgumentError, match='focus="both"'):
        dynoid.fit.armax(data, na=2, nb=2, nc=1, focus="both")  # type: ignore[arg-type]
    with pytest.raises(dynoid.errors.DataError, match="input rows"):
        dynoid.Dataset(np.zeros(10), np.zeros(9), sample_time=1.0)

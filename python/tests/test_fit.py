"""Estimates: their numbers against numpy, scipy and python-control, and what can be done with them."""

from __future__ import annotations

import copy
import pickle
import warnings
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


def test_regress_orders_below_zero_are_refused(data: dynoid.Dataset) -> None:
    with pytest.raises(dynoid.errors.ArgumentError, match="nk=-1: -1 is below zero; give 0 or more: shift the input"):
        dynoid.fit.arx(data, na=2, nb=2, nk=-1)
    with pytest.raises(dynoid.errors.ArgumentError, match=r"nf=\[2, -3\]: -3 is below zero"):
        dynoid.fit.oe(data, nb=2, nf=[2, -3])


def test_exact_a_transfer_function_has_one_zero_less_than_poles(data: dynoid.Dataset) -> None:
    assert dynoid.fit.tf(data, poles=2).parameters == dynoid.fit.tf(data, poles=2, zeros=1).parameters


def test_exact_structures_are_rows_with_their_criteria(data: dynoid.Dataset) -> None:
    orders = dynoid.order(data, na=(1, 3), nb=(1, 2), nk=(1, 2))
    frame = orders.to_pandas()
    assert len(frame) == len(orders.structures) == 12 and not any("." in name for name in frame.columns)
    assert list(frame.columns[:3]) == ["na", "nb", "nk"] and len(frame.columns) < 15
    first = orders.structures[0]
    assert frame["loss"][0] == first.loss and set(vars(first.criteria)) <= set(frame.columns)


def test_exact_one_frequency_and_the_last_instant(data: dynoid.Dataset, fit: dynoid.Fit) -> None:
    assert fit.bode(2.0).magnitude == pytest.approx(fit.bode([1.0, 2.0]).magnitude[1:])
    assert np.array_equal(fit.step(1.0).time, np.arange(11) * 0.1) and np.array_equal(
        fit.step(1.0).response, fit.step(np.arange(11) * 0.1).response
    )
    assert dynoid.fit.tf(data, poles=2).step(3.0).time[-1] == pytest.approx(3.0)
    with pytest.raises(dynoid.errors.ArgumentError, match="or the last one"):
        fit.step(-1.0)


def test_exact_an_infinite_horizon_is_a_simulation(data: dynoid.Dataset, fit: dynoid.Fit) -> None:
    assert np.array_equal(fit.predict(data, float("inf")).y, fit.simulate(data).y)
    for horizon in [0, -1, 1.5, float("nan")]:
        with pytest.raises(dynoid.errors.ArgumentError, match="from 1 on, or infinity"):
            fit.predict(data, horizon)


def test_exact_one_model_or_models_with_names_are_compared(data: dynoid.Dataset, fit: dynoid.Fit) -> None:
    one, several = dynoid.compare(fit, data), dynoid.compare([fit], data)
    assert one.to_dict() == several.to_dict()
    named = dynoid.compare({"right": fit, "small": dynoid.fit.oe(data, nb=1, nf=1)}, data, float("inf"))
    assert named.names == ["right", "small"] and named.best == "right"
    assert named.fit_percent[0] == one.fit_percent[0]


OFFSETS = [
    lambda data: dynoid.fit.tf(data, poles=1, zeros=0, offset=True),
    lambda data: dynoid.fit.process(data, "P1", offset=True),
]


@pytest.mark.parametrize("estimate", OFFSETS)
def test_regress_an_offset_is_kept(estimate, tmp_path: Path) -> None:
    """The level was estimated, and then left out of predictions and comparisons."""
    random = np.random.default_rng(7)
    u = np.repeat(random.choice([1.0, 3.0], 100), 20)
    y = signal.lfilter([0.1], [1.0, -0.9], np.concatenate([[0.0], u[:-1]])) + 0.01 * random.standard_normal(len(u)) + 50.0
    estimation, validation = dynoid.Dataset(y, u, sample_time=0.1).split(0.6)
    fit = estimate(estimation)
    assert fit.offsets["y"] == pytest.approx(50.0, abs=0.02)
    fit.save(tmp_path / "model.json")
    for one in [fit, pickle.loads(pickle.dumps(fit)), dynoid.load(tmp_path / "model.json")]:
        assert one.offsets == pytest.approx(fit.offsets)
        assert one.simulate(validation).y == pytest.approx(validation.y, abs=0.1)
        assert np.std(one.residuals(validation).y) < 0.02 and abs(np.mean(one.residuals(validation).y)) < 0.01
        assert dynoid.compare(one, validation).fit_percent[0][0][0] > 95
        # Data without their mean have no level, and get none.
        assert abs(one.simulate(validation.detrend()).y.mean()) < 1.0
    assert fit.test_residuals(estimation, own=True).joint_whiteness.p_value > 1e-3
    assert dynoid.fit.oe(estimation.detrend(), nb=1, nf=1).offsets == {}


def series(seed: int = 6) -> dynoid.Dataset:
    e = np.random.default_rng(seed).standard_normal(3000)
    return dynoid.Dataset(signal.lfilter([1.0, 0.4], [1.0, -1.2, 0.5], e), sample_time=0.1)


@pytest.mark.parametrize("data", [series()])
def test_ref_poles_and_spectrum_of_a_series(data: dynoid.Dataset) -> None:
    fit = dynoid.fit.armax(data, na=2, nc=1)
    noise = fit.noise()
    a1, a2, c1 = (fit.parameters[name] for name in ("a1", "a2", "c1"))
    poles = sorted((root.value for root in noise.poles()), key=lambda root: root.imag)
    assert poles == pytest.approx(sorted(np.roots([1.0, a1, a2]), key=lambda root: root.imag), rel=1e-9)
    assert noise.zeros()[-1].value == pytest.approx(-c1, rel=1e-9) or noise.zeros()[0].value == pytest.approx(-c1, rel=1e-9)
    assert all(root.damping_interval is not None for root in noise.poles())
    w = np.array([0.5, 2.0, 10.0])
    response = signal.freqz([1.0, c1], [1.0, a1, a2], worN=w * 0.1)[1]
    band = noise.bode(w)
    assert band.magnitude == pytest.approx(np.abs(response), rel=1e-9) and (band.low < band.high).all()
    assert noise.inputs == ["e"] and dynoid.fit.arx(data, na=2, nb=0).noise().poles()
    with pytest.raises(dynoid.errors.ArgumentError, match="no noise model"):
        dynoid.fit.oe(dynoid.Dataset(data.y, data.y, sample_time=0.1), nb=1, nf=1).noise()


def test_ref_other_clocks_are_those_of_scipy(data: dynoid.Dataset) -> None:
    system = dynoid.fit.tf(data, poles=2)
    discrete = system.state_space(sample_time=0.1)
    theirs = system.to_scipy().to_discrete(0.1)
    assert np.sort_complex(np.linalg.eigvals(discrete.A)) == pytest.approx(np.sort_complex(np.linalg.eigvals(theirs.A)), rel=1e-9)
    fit = dynoid.fit.oe(data, nb=2, nf=2)
    continuous = fit.state_space(continuous=True)
    assert continuous.sample_time is None
    poles = np.log([root.value for root in fit.poles()]) / 0.1
    assert np.sort_complex(np.linalg.eigvals(continuous.A)) == pytest.approx(np.sort_complex(poles), rel=1e-6)
    slower = fit.state_space(sample_time=0.2)
    assert np.sort_complex(np.linalg.eigvals(slower.A)) == pytest.approx(np.sort_complex(np.exp(0.2 * poles)), rel=1e-6)
    with pytest.raises(dynoid.errors.ArgumentError, match="either sample_time or continuous"):
        fit.state_space(sample_time=0.1, continuous=True)


def test_ref_initial_states_start_the_prediction(data: dynoid.Dataset, fit: dynoid.Fit) -> None:
    later = data.rows_between(500, 700)
    state, form = fit.initial_states(later)[0], fit.innovations()
    for t in range(20):
        assert form.C @ state + form.D @ later.u[t] == pytest.approx(fit.predict(later).y[t], abs=1e-9)
        error = later.y[t] - (form.C @ state + form.D @ later.u[t])
        state = form.A @ state + form.B @ later.u[t] + form.K @ error


def test_stat_noise_of_simulations_has_the_spectrum_of_the_model() -> None:
    data = series()
    fit = dynoid.fit.armax(data, na=2, nc=1)
    drawn = fit.simulate(data, initial="zero", noise_seed=3)
    assert np.array_equal(drawn.y, fit.simulate(data, initial="zero", noise_seed=3).y)
    again = dynoid.fit.armax(drawn, na=2, nc=1)
    errors = np.array(list(fit.standard_errors.values()))
    assert (np.abs(np.subtract(list(again.parameters.values()), list(fit.parameters.values()))) < 5 * errors).all()
    assert again.noise_covariance == pytest.approx(fit.noise_covariance, rel=0.15)


def test_stat_models_that_are_drawn_scatter_as_the_covariance_says(fit: dynoid.Fit) -> None:
    drawn = np.array([list(one.parameters.values()) for one in fit.sample(2000, seed=4)])
    assert np.cov(drawn.T) == pytest.approx(fit.covariance, rel=0.3, abs=0.1 * np.abs(fit.covariance).max())
    assert fit.sample(2, seed=4)[1].parameters == fit.sample(2, seed=4)[1].parameters


def test_exact_recursive_least_squares_ends_at_least_squares(data: dynoid.Dataset, fit: dynoid.Fit) -> None:
    followed = dynoid.recursive(data, na=2, nb=2, nk=1)
    assert followed.names == list(fit.parameters) and followed.parameters.shape == (2000, 4)
    assert followed.parameters[-1] == pytest.approx(list(fit.parameters.values()), rel=1e-6)
    # The first two samples have no past.
    assert (followed.prediction + followed.error)[2:] == pytest.approx(data.y[2:, 0]) and np.isnan(followed.prediction[:2]).all()
    assert list(followed.to_pandas().columns) == followed.names
    assert dynoid.recursive(data, nb=2, nf=2).parameters[-1] == pytest.approx([1.0, 0.5, -1.5, 0.7], abs=0.2)
    assert dynoid.recursive(data, na=2, nb=2, nc=1, forgetting=0.999).parameters.shape == (2000, 5)
    with pytest.raises(dynoid.errors.ArgumentError, match="output error"):
        dynoid.recursive(data, na=1, nb=1, nf=1)


def test_regress_delays_of_an_output_on_a_slower_clock() -> None:
    """Samples that are missing were refused, though the command takes them."""
    random = np.random.default_rng(3)
    u = np.repeat(random.standard_normal(500), 8)
    y = np.convolve(u, [0, 0, 0, 0, 0, 0.4, 0.24, 0.144, 0.0864, 0.05], "full")[: len(u)]
    y[np.arange(len(y)) % 4 != 0] = np.nan
    slower = dynoid.Dataset({"N": y + 0.01}, {"T": u}, sample_time=0.1)
    with pytest.raises(dynoid.errors.ArgumentError, match="samples are missing"):
        dynoid.order(slower)
    found = dynoid.delay(slower, longest=10).to_dict()
    assert found["delay"][0]["input"] == "T"


def test_regress_frequencies_above_half_the_sampling_rate_are_warned_of(fit: dynoid.Fit) -> None:
    with pytest.warns(UserWarning, match="beyond half the sampling rate, 31.4159"):
        fit.bode([1.0, 40.0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fit.bode()
        fit.bode([1.0, np.pi / 0.1])


def test_regress_residual_tests_name_the_channels(data: dynoid.Dataset, fit: dynoid.Fit) -> None:
    text = str(fit.test_residuals(data))
    assert "residuals of N are white" in text
    assert "dynamics from T to N are complete" in text

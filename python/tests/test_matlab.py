"""The page beside the System Identification Toolbox: its counts, its entries, and the numbers of some of them."""

from __future__ import annotations

import re
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import control
import dynoid
import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import pytest
from conftest import BENCH, program, simulated
from scipy import signal

PAGE = Path(__file__).parents[2] / "docs/src/matlab.md"
STRUCTURE = {
    "parameters": {"gain": {"value": 100.0}, "stiffness": {"value": 20.0, "min": 0}, "damping": {"value": 3.0, "min": 0}},
    "matrices": {"A": [[0, 1], ["-stiffness", "-damping"]], "B": [[0], ["gain"]], "C": [[1, 0]]},
}


def table() -> list[list[str]]:
    """The rows of the page: function, purpose, entry in Python, command."""
    rows = []
    inside = False
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")] if line.startswith("|") else []
        if not cells or line.startswith("| ---"):
            inside = inside and bool(cells)
        elif cells[0] == "function":
            inside = True
        elif inside:
            rows.append(cells)
    return rows


ROWS = table()
IN_PYTHON = [row for row in ROWS if row[2] != "none"]
BY_OTHERS = [row for row in IN_PYTHON if re.search(r" \(with \w+\)$", row[2])]


@pytest.fixture(scope="module")
def names(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the page says that its entries use."""
    matplotlib.use("Agg")
    bench = tmp_path_factory.mktemp("bench") / "bench.toml"
    bench.write_text(BENCH, encoding="utf-8")
    data = simulated(2000, 0.1, 1)
    u, y = data.u[:, 0], data.y[:, 0]
    estimation, validation = data.split(0.6)
    holes, end = y.copy(), y.copy()
    holes[[300, 301, 900]], end[-50:] = np.nan, np.nan
    return {
        "dynoid": dynoid, "np": np, "signal": signal, "control": control,
        "u": u, "y": y, "data": data, "estimation": estimation, "validation": validation, "several": estimation + validation,
        "gaps": dynoid.Dataset({"N": holes}, {"T": u}, sample_time=0.1),
        "future": dynoid.Dataset({"N": end}, {"T": u}, sample_time=0.1),
        "series": noise(), "frame": data.to_pandas(), "structure": STRUCTURE,
        "fit": dynoid.fit.arx(estimation, na=2, nb=2, nk=1), "other": dynoid.fit.oe(estimation, nb=2, nf=2),
        "system": dynoid.fit.tf(estimation, poles=2, zeros=1, delay=0.02),
        "w": np.array([0.5, 2.0, 5.0, 12.0]), "time": np.arange(40) * 0.1, "bench": dynoid.Bench(bench),
    }  # fmt: skip


def noise() -> dynoid.Dataset:
    """A series: y(t) = 1.2 y(t−1) − 0.5 y(t−2) + e(t) + 0.4 e(t−1)."""
    e = np.random.default_rng(6).standard_normal(2000)
    return dynoid.Dataset(signal.lfilter([1.0, 0.4], [1.0, -1.2, 0.5], e), sample_time=0.1)


def test_exact_counts_of_the_page() -> None:
    only_commands = [row for row in ROWS if row[2] == "none" and row[3] != "none"]
    missing = [row for row in ROWS if row[2] == row[3] == "none"]
    assert all(len(row) == 4 and all(row) for row in ROWS)
    assert len({row[0] for row in ROWS}) == len(ROWS)
    assert (
        f"The tables have **{len(ROWS)} rows**. {len(IN_PYTHON) + len(only_commands)} have an equivalent: {len(IN_PYTHON)} in Python, and "
        f"{len(only_commands)} as a command alone. {len(missing)} have none. Of those in Python, {len(BY_OTHERS)} need numpy, scipy or "
        "python-control."
    ) in " ".join(PAGE.read_text(encoding="utf-8").split())


@pytest.mark.parametrize("row", IN_PYTHON, ids=[row[0].replace("`", "") for row in IN_PYTHON])
def test_exact_entries_run(row: list[str], names: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names["frame"].to_csv("run.csv")
    code = re.match(r"`([^`]+)`", row[2])
    assert code, row[2]
    exec(compile(code[1], row[0], "exec"), dict(names))
    plt.close("all")


def test_exact_commands_of_the_page_exist(tmp_path: Path) -> None:
    options: dict[str, set[str]] = {}
    for command in {row[3] for row in ROWS if row[3] != "none"}:
        found = re.fullmatch(r"`dynoid ([a-z]+(?: [a-z]\w+)?)(?: FIRST SECOND)?((?: --[a-z-]+)*)`", command)
        assert found, command
        options.setdefault(found[1], set()).update(found[2].split())
    with ThreadPoolExecutor() as pool:
        shown = dict(zip(options, pool.map(lambda command: program(tmp_path, *command.split(), "--help"), options), strict=True))
    for command, made in shown.items():
        assert made.returncode == 0, made.stderr
        assert all(re.search(rf"{option}\b", made.stdout) for option in options[command]), command


def evaluated(function: str, names: dict[str, Any]) -> Any:
    """The value of the entry of a function."""
    entry = next(row[2] for row in ROWS if row[0].split(",")[0] == f"`{function}`")
    return eval(entry.split("`")[1], dict(names))


def rational(w: np.ndarray, b: list[float], a: list[float]) -> np.ndarray:
    return signal.freqz(b, a, worN=np.asarray(w) * 0.1)[1]


REFERENCES: dict[str, tuple[Callable[[Any], Any], Callable[[dict[str, Any]], Any]]] = {
    "detrend": (lambda r: r.y[:, 0], lambda n: signal.detrend(n["y"])),
    "idfilt": (lambda r: r.u[:, 0], lambda n: signal.lfilter([1], [1, -0.5], n["u"])),
    "getpvec": (lambda r: list(r[0].values()), lambda n: least_squares(n)[0]),
    "getcov": (lambda r: r, lambda n: least_squares(n)[1]),
    "impulseest": (lambda r: list(r.parameters.values())[:5], lambda n: finite_response(n)[:5]),
    "pe": (lambda r: r[2:, 0], lambda n: predicted(n, 1)[1]),
    "predict": (lambda r: r[20:, 0], lambda n: predicted(n, 5)[0][18:]),
    "lsim": (lambda r: r.outputs, lambda n: signal.lfilter(*polynomials(n), n["u"])),
    "freqresp": (lambda r: r, lambda n: rational(n["w"], *polynomials(n))),
    "step": (lambda r: r, lambda n: signal.lfilter(*polynomials(n), np.ones(40))),
    "pole": (lambda r: [r.real, abs(r.imag)], lambda n: [np.roots(polynomials(n)[1])[0].real, abs(np.roots(polynomials(n)[1])[0].imag)]),
    "zero": (lambda r: r, lambda n: np.roots(polynomials(n)[0][1:])[0]),
    "dcgain": (lambda r: r, lambda n: sum(polynomials(n)[0]) / sum(polynomials(n)[1])),
    "tfdata": (lambda r: np.concatenate(r), lambda n: np.concatenate([polynomials(n)[0][1:], polynomials(n)[1]])),
    "nparams": (lambda r: r, lambda n: 4),
    "idpoly": (lambda r: r.simulate(simulated(50, 0.0, 3), initial="zero").y[:, 0],
               lambda n: signal.lfilter([0, 1], [1, -0.9], simulated(50, 0.0, 3).u[:, 0])),
    "forecast": (lambda r: r[:, 0], lambda n: continued(n)),
    "fpe": (lambda r: r, lambda n: squares(n) * (1 + 4 / 1198) / (1 - 4 / 1198)),
}  # fmt: skip


@pytest.mark.parametrize("function", REFERENCES)
def test_ref_entries_give_the_numbers_of_numpy_and_scipy(function: str, names: dict[str, Any]) -> None:
    picked, expected = REFERENCES[function]
    assert picked(evaluated(function, names)) == pytest.approx(expected(names), rel=1e-6, abs=1e-8)


def polynomials(names: dict[str, Any]) -> tuple[list[float], list[float]]:
    """B and A in powers of the shift operator."""
    a1, a2, b1, b2 = names["fit"].parameters.values()
    return [0.0, b1, b2], [1.0, a1, a2]


def least_squares(names: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    u, y = names["estimation"].u[:, 0], names["estimation"].y[:, 0]
    regressor = np.column_stack([-y[1:-1], -y[:-2], u[1:-1], u[:-2]])
    theta = np.linalg.lstsq(regressor, y[2:], rcond=None)[0]
    errors = y[2:] - regressor @ theta
    return theta, errors @ errors / (len(errors) - 4) * np.linalg.inv(regressor.T @ regressor)


def squares(names: dict[str, Any]) -> float:
    """The mean squared error of least squares."""
    u, y = names["estimation"].u[:, 0], names["estimation"].y[:, 0]
    errors = y[2:] - np.column_stack([-y[1:-1], -y[:-2], u[1:-1], u[:-2]]) @ least_squares(names)[0]
    return float(np.mean(errors**2))


def finite_response(names: dict[str, Any]) -> np.ndarray:
    u, y = names["estimation"].u[:, 0], names["estimation"].y[:, 0]
    regressor = np.column_stack([u[29 - lag : len(u) - lag] for lag in range(30)])
    return np.linalg.lstsq(regressor, y[29:], rcond=None)[0]


def predicted(names: dict[str, Any], horizon: int) -> tuple[np.ndarray, np.ndarray]:
    """Predictions of so many samples ahead by the difference equation, from the third sample on, and their errors."""
    b, a = polynomials(names)
    u, y = names["validation"].u[:, 0], names["validation"].y[:, 0]
    ahead = np.zeros(len(y))
    for t in range(2, len(y)):
        past = list(y[max(0, t - horizon - 1) : max(2, t - horizon + 1)])
        for s in range(t - horizon + 1 if t >= horizon + 1 else 2, t + 1):
            past.append(-a[1] * past[-1] - a[2] * past[-2] + b[1] * u[s - 1] + b[2] * u[s - 2])
        ahead[t] = past[-1]
    return ahead[2:], (y - ahead)[2:]


def continued(names: dict[str, Any]) -> np.ndarray:
    """The last fifty outputs, by the difference equation."""
    b, a = polynomials(names)
    u, y = names["u"], list(names["y"][:-50])
    for t in range(len(y), len(u)):
        y.append(-a[1] * y[-1] - a[2] * y[-2] + b[1] * u[t - 1] + b[2] * u[t - 2])
    return np.array(y[-50:])


def test_ref_correlations_in_frequency(names: dict[str, Any]) -> None:
    found = evaluated("spa", names).spectra[0]
    u, y = names["u"] - names["u"].mean(), names["y"] - names["y"].mean()
    lags = np.arange(-100, 101)
    full = {name: np.correlate(one, u, "full")[len(u) - 1 + lags] for name, one in (("yu", y), ("uu", u))}
    transform = np.exp(-0.2j * np.pi * np.outer(found.frequency_hz, lags)) * 0.5 * (1 + np.cos(np.pi * lags / 100))
    expected = (transform @ full["yu"]) / (transform @ full["uu"])
    assert found.magnitude == pytest.approx(np.abs(expected), rel=1e-6)
    turns = (np.array(found.phase_deg) - np.degrees(np.angle(expected))) / 360
    assert turns == pytest.approx(np.round(turns), abs=1e-6)


def test_ref_structures_have_the_losses_of_least_squares(names: dict[str, Any]) -> None:
    best = evaluated("selstruc", names)
    assert (best.na, best.nb, best.nk) == (2, 2, 1)
    exact = dynoid.order(names["estimation"], na=2, nb=2, nk=1).structures[0]
    assert exact.loss == pytest.approx(squares(names), rel=1e-9)


def test_ref_sampling_of_a_continuous_model(names: dict[str, Any]) -> None:
    system = dynoid.fit.tf(names["estimation"], poles=2, zeros=1)
    names = names | {"system": system}
    ours, theirs = evaluated("c2d", names), system.to_scipy().to_discrete(0.1)
    assert np.sort_complex(np.linalg.eigvals(ours.A)) == pytest.approx(np.sort_complex(np.linalg.eigvals(theirs.A)), rel=1e-9)
    gain = ours.C @ np.linalg.solve(np.eye(2) - ours.A, ours.B) + ours.D
    assert gain[0, 0] == pytest.approx(system.bode([1e-9]).magnitude[0], rel=1e-6)


def test_exact_delays_of_python_control_keep_the_channels(names: dict[str, Any]) -> None:
    delayed = names["system"].to_control(pade=2)
    assert (delayed.input_labels, delayed.output_labels) == (["T"], ["N"])
    assert np.angle(delayed(2j)) == pytest.approx(np.deg2rad(names["system"].bode([2.0]).phase[0]), abs=1e-4)


def test_exact_figures_of_poles_and_of_the_complex_plane(names: dict[str, Any]) -> None:
    axes = dynoid.plots.poles(names["fit"])
    values = [complex(x, y) for line in axes.lines for x, y in zip(line.get_xdata(), line.get_ydata(), strict=True)]
    assert values == [root.value for root in names["fit"].poles() + names["fit"].zeros()]
    # An ellipse for each of the three roots, and the unit circle.
    assert len(axes.patches) == 4
    assert len(dynoid.plots.poles(names["system"]).patches) == len(names["system"].poles() + names["system"].zeros())
    bode = names["fit"].bode()
    assert bode.nyquist().lines[0].get_xdata() == pytest.approx(bode.magnitude * np.cos(np.deg2rad(bode.phase)))
    plt.close("all")


def test_regress_what_a_model_lacks_is_said(names: dict[str, Any]) -> None:
    with pytest.raises(dynoid.errors.ArgumentError, match="the model has no input"):
        dynoid.fit.armax(names["series"], na=2, nc=1).to_control()
    with pytest.raises(dynoid.errors.ArgumentError, match='"P1" has no delay'):
        dynoid.fit.process(names["data"], "P1", delay=(0.0, 0.1))

"""Data that the tests share."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import dynoid
import numpy as np
import pytest


def simulated(samples: int, noise: float, seed: int) -> dynoid.Dataset:
    """y(t) = 1.5 y(t−1) − 0.7 y(t−2) + u(t−1) + 0.5 u(t−2) + e(t)."""
    random = np.random.default_rng(seed)
    u, e = random.standard_normal(samples), noise * random.standard_normal(samples)
    y = np.zeros(samples)
    for t in range(2, samples):
        y[t] = 1.5 * y[t - 1] - 0.7 * y[t - 2] + u[t - 1] + 0.5 * u[t - 2] + e[t]
    return dynoid.Dataset({"N": y}, {"T": u}, sample_time=0.1)


@pytest.fixture(scope="session")
def data() -> dynoid.Dataset:
    return simulated(2000, 0.1, 1)


@pytest.fixture(scope="session")
def fit(data: dynoid.Dataset) -> dynoid.Fit:
    return dynoid.fit.arx(data, na=2, nb=2, nk=1)


BENCH = """
[bench]
name = "cell 4"
variant = "load-cell"
cylinders = 4
dynamometer_inertia = 0.6
engine_inertia = 0.28
[limits]
torque = "400 Nm"
[channels]
dyno_speed = "DynoSpeed"
engine_speed = "EngineSpeed"
dyno_speed_demand = "DynoSpeedDemand"
dyno_torque_demand = "DynoTorqueDemand"
air_gap_torque = "DynoTorqueCalc"
load_cell_torque = "DynoTorqueMeas"
system_shaft_torque = "ShaftTorqueCalc"
[recordings]
files = ["*_1200.mf4"]
"""


def program(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """A run of the program, as `python -m dynoid`."""
    return subprocess.run([sys.executable, "-m", "dynoid", *arguments], cwd=folder, capture_output=True, text=True)


@pytest.fixture(scope="session")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bench with two recordings of a simulated one."""
    folder = tmp_path_factory.mktemp("bench")
    (folder / "bench.toml").write_text(BENCH, encoding="utf-8")
    for name in ["BS_T_NT", "WhiteNoise_T_TN"]:
        duration = ["--speed", "1200", "--duration", "12"]
        made = program(folder, "experiment", "simulate", "bench.toml", name, *duration, "--out", f"{name}_1200.mf4")
        assert made.returncode == 0, made.stderr
    return folder / "bench.toml"


@pytest.fixture(scope="session")
def study(bench: Path) -> dynoid.Study:
    """The study of that bench."""
    return dynoid.Study.run(bench)

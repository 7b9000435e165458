"""Parts of a bench, tests and experiments: the numbers that the program gives, as objects."""

from __future__ import annotations

import copy
import json
import pickle
import typing
from collections.abc import Callable
from pathlib import Path

import dynoid
import numpy as np
import pytest
from conftest import program
from dynoid.result import Result

STEP = {"to": "1300 rpm", "duration": 4}


@pytest.fixture(scope="module")
def opened(bench: Path) -> dynoid.Bench:
    return dynoid.Bench(bench)


PARTS = {
    "lines": "lines",
    "torque-signals": "torque_signals",
    "controller": "controller",
    "shaft": "shaft",
    "engine": "engine",
}


@pytest.mark.parametrize("command", PARTS)
def test_exact_a_part_is_that_of_the_program(command: str, opened: dynoid.Bench) -> None:
    result: Result = getattr(opened, PARTS[command])()
    made = program(Path(opened.path).parent, command, "bench.toml", "--json", "--quiet")
    assert made.returncode == 0, made.stderr
    expected = json.loads(made.stdout)
    assert all(expected[key] == value for key, value in result.to_dict().items())
    check(result)
    assert result.document is not None and result.document["format"].startswith("dynoid-")
    assert len(result.to_pandas()) == len(result.to_polars()) > 0


def check(result: Result) -> None:
    """A result has the fields that its class states, shows itself, and is equal to its copies."""
    stated = {name for name in typing.get_type_hints(type(result)) if name != "table"}
    assert set(result.to_dict()) == {name for name in stated if not name.startswith("_") and name not in vars(result)}
    assert repr(result).strip() and "<iframe" in result._repr_html_() and result.markdown().strip()
    for other in [pickle.loads(pickle.dumps(result)), copy.copy(result), copy.deepcopy(result)]:
        assert other == result and repr(other) == repr(result) and other.html() == result.html()


def test_exact_torque_control_and_its_orders(opened: dynoid.Bench) -> None:
    found = opened.torque_control(highest_order=1, longest_delay=1)
    check(found)
    assert len(found.judgements) == len(found.to_pandas()) > 1


def test_exact_recordings_of_a_bench(opened: dynoid.Bench) -> None:
    assert set(opened.recordings()) == {"BS_T_NT_1200.mf4", "WhiteNoise_T_TN_1200.mf4"}
    assert opened.doubts() == [] and opened.name == "cell 4"


def test_exact_recordings_in_memory_give_the_same(opened: dynoid.Bench) -> None:
    folder = Path(opened.path).parent
    files = [dynoid.read(folder / name) for name in opened.recordings()]
    assert dynoid.Bench(opened.path, files).shaft().together == opened.shaft().together


def test_exact_a_test_and_its_verdict(opened: dynoid.Bench, study: dynoid.Study) -> None:
    answer = opened.can("speed-step", model=study, samples=72, require=["speed overshoot below 100 %"])
    check(answer)
    assert answer.samples == 72 and answer.spread == "study" and answer.own[0].kept.of == 72
    assert not answer.is_yes and answer.unchecked
    assert set(answer.to_pandas()["of"]) == {limit.of for limit in answer.limits}


def test_exact_the_experiments(opened: dynoid.Bench, study: dynoid.Study, tmp_path: Path) -> None:
    designed = opened.design("BS_T_NT", speed=1500, duration=5, model=study)
    check(designed)
    assert designed.label == "BS_T_NT" and designed.response is not None and len(designed.recording) > 0
    optimal = opened.design(optimal=["K", "B"], duration=5, peak_shaft_torque=30, model=study)
    assert optimal.optimal is not None and optimal.optimal.goals == ["K", "B"]
    checked = opened.check("Sine_T_TN", duration=5, samples=72, model=study)
    check(checked)
    assert checked.verdict in ("safe", "risky", "unsafe") and isinstance(checked.is_yes, bool)
    run = opened.simulate("BS_T_NT", duration=3, truth=True, seed=2)
    check(run)
    assert run.truth is not None and "DynoSpeed" in run.recording
    assert np.array_equal(opened.simulate("BS_T_NT", duration=3, seed=2).recording["DynoSpeed"].values, run.recording["DynoSpeed"].values)
    run.recording.save(tmp_path / "run.mf4")
    assert np.array_equal(dynoid.read(tmp_path / "run.mf4")["DynoSpeed"].values, run.recording["DynoSpeed"].values)


def test_exact_exports_and_differences(study: dynoid.Study, tmp_path: Path) -> None:
    files = dynoid.export(study, "python", out=tmp_path)
    assert [file.suffix for file in files] == [".py"] and files[0].is_file()
    assert study.model is not None
    study.model.save(tmp_path / "model.json")
    changed = dynoid.diff(tmp_path / "model.json", study)
    assert not changed.is_yes and "cell 4" in repr(study.model)


FAULTS: list[tuple[Callable[[dynoid.Bench], object], type[Exception], str]] = [
    (lambda bench: bench.can("speed-stop"), dynoid.errors.ArgumentError, "speed-step"),
    (lambda bench: bench.can("whtc"), dynoid.errors.ArgumentError, "full-load curve"),
    (lambda bench: bench.check("BS_T_XX"), dynoid.errors.ArgumentError, "BS_T_XX"),
    (lambda bench: bench.design(optimal=["Q"]), dynoid.errors.ArgumentError, "none of"),
    (lambda bench: bench.friction(), dynoid.errors.BenchError, "take the shaft off"),
    (lambda bench: bench.capability(model="no.json"), dynoid.errors.FileError, "no.json"),
]


@pytest.mark.parametrize(("call", "kind", "text"), FAULTS)
def test_regress_a_fault_names_its_remedy(
    call: Callable[[dynoid.Bench], object], kind: type[Exception], text: str, opened: dynoid.Bench
) -> None:
    with pytest.raises(kind, match=text):
        call(opened)

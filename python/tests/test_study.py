"""Studies, and the program that the wheel has."""

from __future__ import annotations

import json
from pathlib import Path

import dynoid
import pytest
from conftest import program


def test_exact_a_study_is_that_of_the_program(bench: Path, study: dynoid.Study, tmp_path: Path) -> None:
    made = program(bench.parent, "study", "bench.toml", "--json", "--quiet")
    assert made.returncode in (0, 1), made.stderr
    short = json.loads(made.stdout)
    assert all(short[key] == value for key, value in study.to_dict().items())
    assert study.level == short["verdict"]["level"] and study.estimates[0].value == short["estimates"][0]["value"]
    written = json.loads((bench.parent / "study" / "study.json").read_text(encoding="utf-8"))
    assert study.document is not None and written["study"]["bench"] == study.document["study"]["bench"]
    assert study.model is not None and study.model.to_dict()["format"] == "dynoid bench model"
    assert study.html().startswith("<!DOCTYPE html>") and study.series is not None
    again = dynoid.Study.load(bench.parent / "study" / "study.json")
    assert again.to_dict() == study.to_dict() and again.notes == []
    study.save(tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")
    frame = study.to_pandas()
    assert list(frame["value"]) == [row.value for row in study.estimates] and (frame["low"] < frame["high"]).all()
    assert study.to_polars("findings").height == len(study.findings)


def test_regress_a_full_study_in_a_folder_has_its_full_report(bench: Path, tmp_path: Path) -> None:
    study = dynoid.Study.run(bench, out=tmp_path / "out", full=True)
    assert study.full is not None and study.full.document is not None
    assert (tmp_path / "out" / "report-full.html").is_file() and (tmp_path / "out" / "study.json").is_file()


def test_exact_progress_of_a_study(bench: Path) -> None:
    heard: list[tuple[float, str]] = []
    dynoid.Study.run(bench, progress=lambda share, step: heard.append((share, step)))
    shares = [share for share, _ in heard]
    assert shares == sorted(shares) and shares[-1] > 0.5 and any("reading" in step for _, step in heard)


def test_regress_an_exception_in_progress_ends_the_study(bench: Path) -> None:
    def stop(share: float, step: str) -> None:
        raise RuntimeError(step)

    with pytest.raises(RuntimeError, match="study"):
        dynoid.Study.run(bench, progress=stop)


def test_regress_a_fault_of_a_bench_file_names_it(tmp_path: Path) -> None:
    (tmp_path / "bench.toml").write_text("[bench]\n", encoding="utf-8")
    with pytest.raises(dynoid.errors.BenchError) as caught:
        dynoid.Study.run(tmp_path / "bench.toml")
    assert caught.value.file == str(tmp_path / "bench.toml")


def test_exact_the_program_has_its_exit_codes(tmp_path: Path) -> None:
    assert program(tmp_path, "--version").stdout.startswith("dynoid ")
    assert program(tmp_path, "inspect", "none.mf4").returncode == 3
    assert program(tmp_path, "no-such-command").returncode == 2

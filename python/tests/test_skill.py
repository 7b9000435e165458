"""The skill file: its commands run in their order, and their JSON has the fields that the file names."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from typing import Any

import pytest
from conftest import BENCH, program

SKILL = Path(__file__).parents[2] / "docs/skills/identify-a-bench/SKILL.md"
BLOCK = re.compile(r"```console(?: exit=(\d+))?\n(.*?)```", re.DOTALL)
# Fields that the file says to read, by the command. `a.b` is the field b of a; a list has it in its first entry.
FIELDS: dict[str, list[str]] = {
    "inspect": ["file", "label", "rasters", "findings"],
    "init": ["channels.role", "channels.confidence", "ambiguous", "missing", "to_fill_in"],
    "study": [
        "verdict.level", "verdict.rules.asks", "verdict.rules.found", "verdict.rules.outcome",
        "findings.severity", "findings.text", "findings.advice", "not_estimated.part", "not_estimated.needs",
        "estimates.key", "estimates.value", "estimates.unit", "estimates.interval",
    ],
    "next": ["candidates.label", "candidates.safety", "candidates.gains.now", "candidates.gains.then"],
    "check": ["verdict", "unchecked", "beyond"],
    "can": ["answer", "sentence", "kept", "limits", "unchecked", "beyond"],
    "export": ["files"],
    "diff": ["changed"],
}  # fmt: skip


def commands() -> list[tuple[list[str], int]]:
    """The commands of the file, each with its exit code."""
    found = []
    for code, block in BLOCK.findall(SKILL.read_text(encoding="utf-8")):
        lines = [line.removeprefix("$ ") for line in block.splitlines() if line.startswith("$ ")]
        found += [(shlex.split(line), int(code or 0)) for line in lines]
    return found


def name_of(arguments: list[str]) -> str:
    """The name of a command, without the group that it belongs to."""
    return arguments[2] if arguments[1] == "experiment" else arguments[1]


def has(value: Any, path: str) -> bool:
    """Tells whether a document has a field."""
    for name in path.split("."):
        value = value[0] if isinstance(value, list) else value
        if not isinstance(value, dict) or name not in value:
            return False
        value = value[name]
    return True


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A bench whose recordings do not show everything."""
    (tmp_path / "bench.toml").write_text(BENCH.replace('"*_1200.mf4"', '"recordings/*.mf4"'), encoding="utf-8")
    (tmp_path / "recordings").mkdir()
    for name in ["BS_T_NT", "WhiteNoise_T_TN"]:
        out = f"recordings/{name}_1200.mf4"
        made = program(tmp_path, "experiment", "simulate", "bench.toml", name, "--speed", "1200", "--duration", "12", "--out", out)
        assert made.returncode == 0, made.stderr
    return tmp_path


def test_exact_commands_of_the_skill(folder: Path) -> None:
    run = []
    for arguments, code in commands():
        assert arguments[0] == "dynoid"
        made = program(folder, *arguments[1:])
        assert made.returncode == code, f"{arguments}: {made.stdout}{made.stderr}"
        name = name_of(arguments)
        if "--json" in arguments:
            lacking = [path for path in FIELDS[name] if not has(json.loads(made.stdout), path)]
            assert not lacking, f"{name} has no {lacking}"
            run.append(name)
    assert run == list(FIELDS)


def test_exact_fields_are_in_the_text() -> None:
    text = SKILL.read_text(encoding="utf-8")
    for path in sum(FIELDS.values(), []):
        assert f"`{path}`" in text or f"`{path.rsplit('.', 1)[-1]}`" in text, path


def test_exact_front_matter() -> None:
    head = SKILL.read_text(encoding="utf-8").split("---\n")[1]
    entries = dict(line.split(": ", 1) for line in head.splitlines())
    assert entries["name"] == SKILL.parent.name and len(entries["description"]) < 1024


def test_exact_links_of_llms_txt() -> None:
    root = SKILL.parents[3]
    text = (root / "llms.txt").read_text(encoding="utf-8")
    links = re.findall(r"\]\(([^)]+)\)", text)
    assert text.startswith("# dynoid\n\n> ") and len(links) == len(set(links)) > 20
    assert [link for link in links if not (root / link).is_file()] == []

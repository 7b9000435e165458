"""The stubs say what the compiled part has, and the package passes the strict check of types."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import dynoid

ROOT = Path(__file__).parents[2]


def run(*arguments: str) -> None:
    package = str(Path(dynoid.__file__).parents[1])
    made = subprocess.run(
        [sys.executable, "-m", *arguments], cwd=ROOT, env={"PYTHONPATH": package, "MYPYPATH": package, "PATH": ""},
        capture_output=True, text=True,
    )  # fmt: skip
    assert made.returncode == 0, made.stdout + made.stderr


def test_ref_stubs_and_types() -> None:
    run("mypy.stubtest", "dynoid._dynoid", "--mypy-config-file", str(ROOT / "pyproject.toml"))
    run("mypy", "--config-file", str(ROOT / "pyproject.toml"))

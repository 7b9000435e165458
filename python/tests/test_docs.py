"""Examples in the documentation, which are run."""

from __future__ import annotations

import doctest
import re
import shutil
from pathlib import Path
from typing import Any

import dynoid
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]


def test_exact_examples_of_the_package() -> None:
    outcome = doctest.testmod(dynoid)
    assert outcome.attempted > 5 and outcome.failed == 0


@pytest.mark.parametrize("page", ["README.md", "docs/src/python.md"])
def test_exact_examples_of_the_pages(
    page: str, bench: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A copy, since the examples write files that other tests have to find absent.
    monkeypatch.chdir(shutil.copytree(bench.parent, tmp_path / "bench"))
    monkeypatch.setenv("MPLBACKEND", "Agg")
    random = np.random.default_rng(3)
    time, u = np.arange(3000) * 0.01, random.standard_normal((3000, 2))
    y = np.zeros(3000)
    for t in range(3, 3000):
        y[t] = 0.9 * y[t - 1] + u[t - 3, 0] + 0.2 * u[t - 1, 1] + 0.1 * random.standard_normal()
    rows = "".join(f"{s},{a},{b},{c}\n" for s, a, b, c in zip(time, u[:, 0], u[:, 1], y, strict=True))
    Path("run.mf4").write_text("time [s],T [Nm],p [bar],N [rpm]\n" + rows, encoding="utf-8")
    recording = dynoid.read("run.mf4")
    names: dict[str, Any] = {
        "dynoid": dynoid, "first": recording, "second": recording, "u": u, "y": y, "w": np.array([1.0, 10.0]),
    }  # fmt: skip
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL)
    assert blocks
    for block in blocks:
        exec(compile(block, page, "exec"), names)
    assert isinstance(names["study"], dynoid.Study) and names["fit"].intervals(0.95)

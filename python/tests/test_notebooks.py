"""The notebooks: valid, without outputs, and with a page in the book. `docs/notebooks/run.py` executes them."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_exact_a_notebook_is_valid_and_without_outputs(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    notebook = json.loads(text)
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    assert text == json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", "save it with an indent of 1"
    cells = notebook["cells"]
    assert len({cell["id"] for cell in cells}) == len(cells)
    for cell in cells:
        assert isinstance(cell["source"], list) and cell["metadata"] == {}
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None, "clear all outputs"
            ast.parse("".join(cell["source"]))
        else:
            assert cell["cell_type"] == "markdown" and set(cell) == {"cell_type", "id", "metadata", "source"}


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_exact_a_page_has_the_text_and_the_cells_of_its_notebook(path: Path) -> None:
    page = (DOCS / "src/notebooks" / f"{path.stem}.md").read_text(encoding="utf-8")
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        assert "".join(cell["source"]) in page, "run docs/notebooks/run.py"


def test_exact_the_book_lists_every_notebook_by_its_heading() -> None:
    summary = (DOCS / "src/SUMMARY.md").read_text(encoding="utf-8")
    headings = {path.stem: json.loads(path.read_text(encoding="utf-8"))["cells"][0]["source"][0].strip() for path in NOTEBOOKS}
    lines = [f"- [{heading.removeprefix('# ')}](notebooks/{stem}.md)" for stem, heading in headings.items()]
    assert len(lines) == 6 and "# Notebooks\n\n" + "\n".join(lines) + "\n" in summary


def test_exact_figures_of_the_pages_are_small() -> None:
    for figure in (DOCS / "src/notebooks").glob("*.png"):
        assert figure.stat().st_size < 60_000, figure.name
        assert f"({figure.name})" in (DOCS / "src/notebooks" / f"{figure.stem.rsplit('-', 1)[0]}.md").read_text(encoding="utf-8")

"""The notebooks, executed: each becomes a page of the book with its outputs and figures.

`python docs/notebooks/run.py [NAME …]` runs all notebooks, or those whose names begin with NAME. It fails where a cell raises, and so the run
is a test. It needs the packages of xtask/notebooks.txt and the module dynoid.
"""

from __future__ import annotations

import argparse
import base64
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, CellTimeoutError

NOTEBOOKS = Path(__file__).parent
PAGES = NOTEBOOKS.parent / "src" / "notebooks"
SLOWEST_CELL_S = 600
LARGEST_FIGURE = 60_000
# Figures without the version of matplotlib, so that they change with their content alone.
SETUP = "%config InlineBackend.print_figure_kwargs = {'metadata': {'Software': None}, 'bbox_inches': 'tight', 'dpi': 90}"


def main() -> int:
    """Runs the notebooks that the command line names, and writes their pages."""
    parser = argparse.ArgumentParser(description="Run the notebooks, and write their pages.")
    parser.add_argument("names", nargs="*", default=[""], help="first letters of notebooks; without them all are run")
    parser.add_argument("--out", type=Path, default=PAGES, help="folder of the pages")
    options = parser.parse_args()
    chosen = [path for path in sorted(NOTEBOOKS.glob("*.ipynb")) if path.name.startswith(tuple(options.names))]
    failed = [path.stem for path in chosen if not page(path, options.out)]
    if failed or not chosen:
        print(f"failed: {', '.join(failed)}" if chosen else "no notebook has such a name", file=sys.stderr)
        return 1
    return 0


def page(path: Path, out: Path) -> bool:
    """Runs one notebook in an empty folder, and writes its page. Returns false where a cell raises."""
    notebook = nbformat.read(path, as_version=4)
    start = time.monotonic()
    notebook.cells.insert(0, nbformat.v4.new_code_cell(SETUP))
    with tempfile.TemporaryDirectory() as above:
        # Some outputs show the name of the folder.
        folder = str(Path(above, path.stem))
        Path(folder).mkdir()
        client = NotebookClient(notebook, timeout=SLOWEST_CELL_S, kernel_name="python3", resources={"metadata": {"path": folder}})
        try:
            client.execute(env={**os.environ, "MPLBACKEND": "module://matplotlib_inline.backend_inline"})
        except (CellExecutionError, CellTimeoutError) as error:
            print(f"{path.name}: {error}", file=sys.stderr)
            return False
        text, figures = markdown(notebook.cells[1:], path.stem, folder)
    out.mkdir(parents=True, exist_ok=True)
    for old in out.glob(f"{path.stem}-*.png"):
        old.unlink()
    for name, figure in figures.items():
        if len(figure) > LARGEST_FIGURE:
            raise ValueError(f"{name} has {len(figure)} bytes; draw fewer points")
        (out / name).write_bytes(figure)
    (out / f"{path.stem}.md").write_text(text, encoding="utf-8")
    print(f"{path.stem}: {time.monotonic() - start:.0f} s, {len(figures)} figures")
    return True


def markdown(cells: list[Any], stem: str, folder: str) -> tuple[str, dict[str, bytes]]:
    """The page of executed cells, and its figures by their names."""
    parts: list[str] = []
    figures: dict[str, bytes] = {}
    for cell in cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        for output in joined(cell.outputs):
            shown = output.get("data", {})
            if "image/png" in shown:
                name = f"{stem}-{len(figures) + 1}.png"
                figures[name] = base64.b64decode(shown["image/png"])
                parts.append(f"![Figure {len(figures)}]({name})")
            else:
                text = output.get("text") or shown.get("text/plain", "")
                parts.append(f"```text\n{tidy(text, folder)}\n```")
    return "\n\n".join(parts) + "\n", figures


def joined(outputs: list[Any]) -> list[Any]:
    """The outputs, with the pieces of a printed text in one."""
    whole: list[Any] = []
    for output in outputs:
        if whole and output.output_type == whole[-1].output_type == "stream":
            whole[-1].text += output.text
        else:
            whole.append(output)
    return whole


def tidy(text: str, folder: str) -> str:
    """A text without the folder of the run, and without blanks at the ends of its lines."""
    return "\n".join(line.rstrip() for line in text.replace(f"{folder}/", "").strip("\n").splitlines())


if __name__ == "__main__":
    sys.exit(main())

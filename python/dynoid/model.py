"""Bench models."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from . import _dynoid
from .result import Difference

if TYPE_CHECKING:
    from .study import Study

Target = Literal["mat", "modelica", "python", "fmu2", "fmu3", "c", "ssp", "ssv", "linear"]
"""Programs to which a model is exported."""


@dataclass(frozen=True)
class BenchModel:
    """The model of a bench, as a study makes it."""

    text: str
    """The text of its file, `model.json`."""

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> BenchModel:
        """The model of a file."""
        return cls(Path(path).read_text(encoding="utf-8"))

    def to_dict(self) -> dict[str, Any]:
        """The model as dictionaries and lists."""
        entries: dict[str, Any] = json.loads(self.text)
        return entries

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes the file of the model."""
        with open(path, "w" if overwrite else "x", encoding="utf-8") as file:
            file.write(self.text)

    def __repr__(self) -> str:
        return f"model of the bench {self.to_dict()['bench']['name']}"


AnyModel = "Study | BenchModel | str | os.PathLike[str] | None"


def given(model: Any) -> dict[str, str | None]:
    """The file of a model, or its text."""
    text = getattr(model, "model", model)
    if text is None and model is not None:
        raise ValueError("the study has no model; its report says what is missing")
    if isinstance(text, BenchModel):
        return {"path": None, "text": text.text}
    return {"path": None if text is None else os.fspath(text), "text": None}


def export(
    model: Study | BenchModel | str | os.PathLike[str],
    to: Target,
    *,
    out: str | os.PathLike[str] | None = None,
    draws: int = 0,
    overwrite: bool = False,
) -> list[Path]:
    """Writes a model as the files of another program, and returns their paths.

    A file may hold a bench model, a model of `dynoid.fit` or an FMU of dynoid. `out` is a folder, or, for the model of a file, the name of the
    first file. With `to="ssv"`, `draws` benches are drawn from the covariance.
    """
    return [Path(path) for path in _dynoid.export(given(model), to, out, draws, overwrite)]


def diff(
    old: Study | BenchModel | str | os.PathLike[str], new: Study | BenchModel | str | os.PathLike[str]
) -> Difference:
    """Two models of a bench, compared parameter by parameter."""
    names = [os.fspath(one) if isinstance(one, (str, os.PathLike)) else word for one, word in ((old, "old"), (new, "new"))]
    return Difference(_dynoid.difference(given(old), given(new), (names[0], names[1])))

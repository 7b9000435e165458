"""Studies of a bench."""

from __future__ import annotations

import html
import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _dynoid

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class Study:
    """Everything learnt from the recordings of a bench."""

    summary: dict[str, Any]
    """Verdict with its rules, key numbers with intervals, what is not estimated and why, and findings."""
    document: dict[str, Any]
    """The whole study, as `dynoid study` writes it to `study.json`."""
    model: str | None
    """The bench model, as the text of `model.json`; none where the recordings give none."""
    report: str
    """The report, as an HTML page."""

    @classmethod
    def run(
        cls,
        bench: str | os.PathLike[str],
        *,
        progress: Callable[[float, str], object] | None = None,
        threads: int | None = None,
    ) -> Study:
        """Studies a bench with the recordings that its file lists.

        `progress` is called with the part that is done, from 0 to 1, and with the step under way. An exception that it raises ends the study, and
        so does Ctrl-C.
        """
        return cls(*_dynoid.study(bench, progress, threads))

    @property
    def level(self) -> str:
        """The verdict in a word: `good`, `reservations` or `insufficient`."""
        return str(self.summary["level"])

    @property
    def estimates(self) -> list[dict[str, Any]]:
        """Key numbers: each with its part, quantity, value, standard error and 95 % interval, in SI."""
        return list(self.summary["estimates"])

    def to_pandas(self) -> pandas.DataFrame:
        """The key numbers as a frame of pandas."""
        import pandas

        rows = [{key: value for key, value in row.items() if key != "interval"} for row in self.estimates]
        frame = pandas.DataFrame(rows)
        frame["low"] = [row["interval"][0] for row in self.estimates]
        frame["high"] = [row["interval"][1] for row in self.estimates]
        return frame

    def __repr__(self) -> str:
        lines = [f"{self.summary['bench']}: {self.summary['headline']}"]
        lines += [f"  {rule['outcome']}: {rule['asks']} {rule['found']}" for rule in self.summary["rules"]]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{html.escape(self.report)}" style="width: 100%; height: 40em; border: 0"></iframe>'

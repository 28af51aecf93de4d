"""The table of the hostile set: what each attack tried, and what held, from what happened in this run."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from tests.grading.conftest import ROOT

if TYPE_CHECKING:
    from course_kit.grading import Isolation, Report

PATH = ROOT / "artifacts" / "hostile_set.md"


@dataclass
class Table:
    """Rows as they come; written only when all are there, so that a part of the tests leaves the whole table be."""

    isolation: Isolation
    rows: dict[str, tuple[str, str, str]] = field(default_factory=dict)

    def add(self, attack: str, report: Report, held: str) -> None:
        """Take the row of an attack whose test has passed so far."""
        first = report.checks[0]
        points = f"{report.score:g} of {report.max_score:g}"
        self.rows[attack] = (points, first.diagnosis or first.status, held)

    def write(self, expected: set[str]) -> None:
        """Write the table if no attack of `expected` is missing."""
        if not expected <= set(self.rows):
            return
        lines = [
            "# The hostile set",
            "",
            f"Isolation in this run: {self.isolation.describe()}.",
            "",
            "| a submission | points | verdict | what held |",
            "|---|---|---|---|",
        ]
        lines += [f"| {attack} | {' | '.join(_cell(cell) for cell in row)} |" for attack, row in self.rows.items()]
        PATH.parent.mkdir(exist_ok=True)
        PATH.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _cell(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())

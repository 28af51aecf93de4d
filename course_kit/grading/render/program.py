"""The program in a report: its lines, and which of them a failed check speaks of."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.model.report import Report
    from course_kit.grading.model.submission import Submission

MOST_LINES = 1500
LONGEST = 500  # characters of a line that are shown
# As `Submission.where` words it; what a learner's program says may look like it, and then marks a line too many.
_PLACE = re.compile(r"\b(?:cell \d{1,6}, )?line \d{1,6}\b")


@dataclass(frozen=True)
class ProgramLine:
    """One line of a program."""

    number: int  # in the program, from 1
    place: str  # what messages call it, `line 12` or `cell 3, line 2`
    text: str  # the line, cut if it is very long
    checks: tuple[str, ...] = ()  # titles of the failed checks that speak of it


def lines(report: Report, program: Submission) -> Sequence[ProgramLine]:
    """The program's lines, up to `MOST_LINES`; those that a failed check names are marked with its title."""
    named: dict[str, list[str]] = {}
    for title, text in _told(report):
        for place in dict.fromkeys(_PLACE.findall(text)):
            named.setdefault(place, []).append(title)
    found = []
    for number, text in enumerate(program.source.rstrip("\n").split("\n")[:MOST_LINES], start=1):
        place = program.where(number)
        found.append(ProgramLine(number, place, text[:LONGEST], tuple(named.get(place, ()))))
    return found


def _told(report: Report) -> list[tuple[str, str]]:
    """What is said about failures, and by what."""
    told = [(check.title, check.told or check.message) for check in report.checks if check.status == "failed"]
    return [*told, (report.title, report.problem)] if report.problem else told

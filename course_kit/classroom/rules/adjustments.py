"""What an instructor's rules and decisions make of a result: lateness and its penalty, an override, a comment.

None of this is stored with the result. It is worked out again from the instructor's files for each gradebook, so that
a rule that changes needs no grading.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime  # noqa: TC003 - msgspec looks it up
from typing import TYPE_CHECKING

from course_kit.text.console import in_points

if TYPE_CHECKING:
    from collections.abc import Iterator

_DAY_S, _HOUR_S, _MINUTE_S = 86_400, 3_600, 60


@dataclass(frozen=True)
class Adjustment:
    """What is added to one result."""

    pass_mark: float | None = None  # the points from which it is passed; None where nothing is adjusted
    submitted: datetime | None = None  # when it was handed in, with its time zone; None where nobody knows
    due: datetime | None = None  # when it was due, with its time zone and any extension; None without a due date
    extended: bool = False  # whether that is the student's own date
    late: bool = False  # whether it counts as late
    late_s: float = 0.0  # how long after `due` it was handed in, in seconds; 0 where the time is not known
    penalty: float = 0.0  # points taken for that
    override: float | None = None  # the score that the instructor has set; None when the checks' one counts
    added: float = 0.0  # points that the instructor has added to those of the checks
    # titles of checks whose points the instructor has set, each with the points before and after
    checks: tuple[tuple[str, float, float], ...] = ()
    comment: str = ""  # the instructor's, for the student
    warning: str = ""  # what the instructor should look at, such as a time that is not known; empty when all is clear

    def score(self, graded: float, most: float) -> float:
        """The score that counts, where the checks gave `graded` of `most`."""
        if self.override is not None:
            return self.override
        graded += sum(after - before for _, before, after in self.checks)
        return min(most, max(0.0, graded - self.penalty) + self.added)


def describe_adjustment(adjustment: Adjustment, graded: float | None) -> Iterator[str]:
    """What a student reads about it, a sentence each."""
    if adjustment.late:
        yield _lateness(adjustment)
    if adjustment.penalty and adjustment.override is None:
        taken, whole = in_points(adjustment.penalty), in_points(graded or 0.0)
        yield f"Late penalty: {taken}, taken from the {whole} of the checks."
    for title, before, after in adjustment.checks:
        yield f'Your instructor has set "{title}" to {in_points(after)}; the check gave {before:g}.'
    if adjustment.override is not None:
        instead = "" if graded is None else f"; the checks gave {graded:g}"
        yield f"Your instructor has set this score to {in_points(adjustment.override)}{instead}."
    if adjustment.added:
        yield f"Your instructor has added {in_points(adjustment.added)}."
    if adjustment.comment:
        yield f"Comment from your instructor: {adjustment.comment}"


def _lateness(adjustment: Adjustment) -> str:
    if adjustment.submitted is None or adjustment.due is None:
        return "Handed in late."
    own = ", your own date" if adjustment.extended else ""
    when = f"on {format_moment(adjustment.submitted)}, due {format_moment(adjustment.due)}{own}"
    return f"Handed in {format_duration(adjustment.late_s)} late: {when}."


def format_moment(moment: datetime) -> str:
    """A moment for people, with its time zone: `2026-11-22 23:59 CET (UTC+01:00)`."""
    offset = moment.strftime("%z")
    utc = f"UTC{offset[:3]}:{offset[3:5]}" if moment.utcoffset() else "UTC"
    name = moment.tzname() or ""
    zone = utc if not name or name.startswith("UTC") else f"{name} ({utc})"
    return f"{moment:%Y-%m-%d %H:%M} {zone}"


def format_duration(seconds: float) -> str:
    """A time for people in two units: `2 d 3 h`, `5 min`."""
    minutes = max(1, round(seconds / _MINUTE_S))
    days, rest = divmod(minutes * _MINUTE_S, _DAY_S)
    hours, rest = divmod(rest, _HOUR_S)
    parts = [(days, "d"), (hours, "h"), (rest // _MINUTE_S, "min")]
    pieces = [f"{count} {unit}" for count, unit in parts if count]
    return " ".join(pieces[:2])

"""The numbers behind the class page."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_kit.classroom.exports.results import score

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record
    from course_kit.grading.exercise import Exercise

_MOST_BARS = 21
BANDS = ("under 25 %", "25 to 50 %", "50 to 75 %", "75 % and more")


@dataclass(frozen=True)
class Bar:
    """One bar of a distribution: from `low` points on, up to the next one's."""

    low: float
    label: str
    count: int


@dataclass
class CheckCount:
    """How often a check came out how: by its status, and whose it is that failed."""

    id: str
    title: str
    points: float
    by_status: Counter[str] = field(default_factory=Counter)
    failed: list[Record] = field(default_factory=list)

    @property
    def run(self) -> int:
        """How often it could be run at all."""
        return self.by_status["passed"] + self.by_status["failed"]


def distribution(exercise: Exercise, records: Sequence[Record]) -> list[Bar]:
    """How many have how many points: a bar for each point, or ten where there are many; the last is full marks."""
    points = [found for record in records if (found := score(record)) is not None]
    steps = int(exercise.points) if exercise.points == int(exercise.points) and exercise.points < _MOST_BARS else 10
    width = exercise.points / steps
    counts = Counter(min(steps, max(0, math.floor(one / width + 1e-9))) for one in points)
    return [Bar(step * width, f"{step * width:g}", counts[step]) for step in range(steps + 1)]


def checks(records: Sequence[Record]) -> list[CheckCount]:
    """The checks of one exercise in the order they are run."""
    found: dict[str, CheckCount] = {}
    for record in records:
        for check in record.report["checks"]:
            one = found.setdefault(check["id"], CheckCount(check["id"], check["title"], float(check["max_points"])))
            one.by_status[check["status"]] += 1
            if check["status"] == "failed":
                one.failed.append(record)
    return list(found.values())


def diagnoses_by_exercise(book: Gradebook) -> dict[str, list[int]]:
    """For each diagnosis how many submissions of each exercise have it, the most frequent first."""
    order = [exercise.id for exercise in book.exercises]
    return _table(
        ((code, order.index(record.entry.exercise)) for record in book.graded() for code in record.diagnoses),
        len(order),
    )


def diagnoses_by_band(records: Sequence[Record]) -> dict[str, list[int]]:
    """For each diagnosis how many submissions of each of `BANDS` have it, the most frequent first."""
    return _table(((code, _band(record)) for record in records for code in record.diagnoses), len(BANDS))


def having_diagnoses(records: Sequence[Record]) -> dict[str, list[Record]]:
    """For each diagnosis the records that have it."""
    table: dict[str, list[Record]] = {}
    for record in records:
        for code in record.diagnoses:
            table.setdefault(code, []).append(record)
    return table


def _band(record: Record) -> int:
    reached = record.score / record.max_score if record.max_score else 0.0
    return min(len(BANDS) - 1, int(reached * len(BANDS)))


def _table(places: Iterable[tuple[str, int]], width: int) -> dict[str, list[int]]:
    table: dict[str, list[int]] = {}
    for code, column in places:
        table.setdefault(code, [0] * width)[column] += 1
    return dict(sorted(table.items(), key=lambda item: (-sum(item[1]), item[0])))

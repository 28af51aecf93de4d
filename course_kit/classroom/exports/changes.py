"""What is different from the results that the last run into the same folder has left."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.classroom.exports.texts import format_number, score_of
from course_kit.classroom.records import outcome_of
from course_kit.environment import write_atomically

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from course_kit.classroom.records import Gradebook, GradeRecord

FILE = "last_run.json"
FORMAT_VERSION = 1
NEW, GONE, CHANGED = "new", "gone", "changed"

Key = tuple[str, str]
Result = tuple[str, str]


@dataclass(frozen=True)
class ResultChange:
    """One submission's result that is not what it was."""

    student: str  # whose
    exercise: str  # the exercise's id
    kind: str  # NEW, GONE or CHANGED
    before: str = ""  # the result of before, in words; empty where there was none
    now: str = ""  # the result of now; empty if it is gone
    new_file: bool = False  # whether a different file was handed in


def since_last_run(book: Gradebook, out: Path) -> list[ResultChange]:
    """Compare with what `remember` has left; nothing where there was no run before."""
    before = _read(out / FILE)
    if before is None:
        return []
    now = _results(book)
    found = [_change(key, before.get(key), now.get(key)) for key in sorted({*before, *now})]
    return [change for change in found if change is not None]


def remember_results(book: Gradebook, out: Path) -> None:
    """Keep the results for the next run to compare with."""
    rows = [[*key, *result] for key, result in sorted(_results(book).items())]
    text = json.dumps({"format_version": FORMAT_VERSION, "results": rows}, indent=0)
    write_atomically(out / FILE, text + "\n", durable=False)


def _results(book: Gradebook) -> dict[Key, Result]:
    """For each submission the result in words, and what was handed in."""
    return {(grade.entry.student, grade.entry.exercise): (_in_words(grade), grade.digest) for grade in book.records}


def _in_words(record: GradeRecord) -> str:
    points = score_of(record)
    return "grader's error" if points is None else f"{format_number(points)}, {outcome_of(record)}"


def _change(key: Key, before: Result | None, now: Result | None) -> ResultChange | None:
    if before is None or now is None:
        found = now or before or ("", "")
        return ResultChange(*key, NEW, now=found[0]) if before is None else ResultChange(*key, GONE, before=found[0])
    if before == now:
        return None
    return ResultChange(*key, CHANGED, before[0], now[0], new_file=before[1] != now[1])


def _read(path: Path) -> Mapping[Key, Result] | None:
    """The results of the last run; None if they cannot be read."""
    try:
        before = json.loads(path.read_text(encoding="utf-8"))
        if before["format_version"] != FORMAT_VERSION:
            return None
        return {(student, exercise): (result, digest) for student, exercise, result, digest in before["results"]}
    except (OSError, ValueError, KeyError, TypeError):
        return None

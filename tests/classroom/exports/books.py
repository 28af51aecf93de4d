"""Gradebooks made by hand, with the names that files stumble over."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Any

from course_kit.classroom.records import Entry, Gradebook, GradeRecord
from course_kit.grading.model.exercise import Exercise, load_exercise

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    Maker = Callable[..., GradeRecord]

SERVICE = load_exercise("temperature_service")
ROBOT = load_exercise("move_robot")
CHOICE = load_exercise("pattern_choice")

HOSTILE = (
    '=HYPERLINK("http://evil.example","click")',
    "+1+1",
    "-2+3",
    "@SUM(A1)",
    "\t=1+1",
    "\r=1+1",
    " \u200b=1+1",
    "<script>alert(1)</script>",
    '"; DROP TABLE students; --',
    "Müller, Jörg, jr.",
    'Jane "the\nman" Doe',
    "سارة أحمد",
    "a \u202egnirts desrever",
    "👩‍👩‍👧 李娜 😀",
    "می‌خواهم",
    "Points Possible",
    "half a character \udc80",
    "bell \x07 null \x00 escape \x1b[31m ]]>",
    "x" * 500,
    "${7*7} {{7*7}} %s",
)


def check(name: str, status: str = "passed", points: float = 5.0, **more: Any) -> dict[str, Any]:
    return {
        "id": name,
        "title": f"The check {name}",
        "status": status,
        "points": points if status == "passed" else 0.0,
        "max_points": points,
        "sent": "",
        "expected": "",
        "got": "",
        "diagnosis": None,
        "message": "" if status == "passed" else f"{name} did not hold.",
        "hint": None,
        **more,
    }


def record(  # noqa: PLR0913 - each with a default, for tests to name what they are about
    student: str,
    checks: Iterable[dict[str, Any]] = (),
    *,
    of: Exercise = SERVICE,
    status: str = "graded",
    digest: str = "",
    size: int = 1000,
    same_as: str = "",
    stderr: str = "",
    source: str = "",
    **entry: Any,
) -> GradeRecord:
    listed = list(checks)
    score = sum(one["points"] for one in listed)
    report = {
        "format_version": 1,
        "exercise": of.id,
        "submission": source,
        "status": status,
        "score": score,
        "max_score": of.points,
        "passed": status == "graded" and score >= of.pass_mark,
        "duration_s": 1.25,
        "checks": listed,
        "stdout": "",
        "stderr": stderr,
    }
    place = Entry(student, of.id, source or f"{student}/{of.starter}", **entry)
    return GradeRecord(place, digest or student, size, 7, report, title=of.title, wall_s=2.0, same_as=same_as)


def good(student: str, **more: Any) -> GradeRecord:
    return record(student, [check("first"), check("second")], **more)


def bad(student: str, diagnosis: str = "service.no_return", **more: Any) -> GradeRecord:
    failed = check("first", "failed", diagnosis=diagnosis, sent="1 °C", expected="33.8", got="0", hint="Look <again>.")
    return record(student, [failed, check("second", "skipped")], **more)


def unreadable(student: str, **more: Any) -> GradeRecord:
    return record(student, status="unreadable", stderr="answer.py is empty.", **more)


def not_graded(student: str, **more: Any) -> GradeRecord:
    return record(student, status="error", stderr="the worker was gone", **more)


def book(*records: GradeRecord, exercises: tuple[Exercise, ...] = (SERVICE,), **more: Any) -> Gradebook:
    found = tuple(sorted(records, key=lambda one: (one.entry.student, one.entry.exercise)))
    return Gradebook(exercises, found, layout=more.pop("layout", "folders"), seed=7, **more)


def hostile_book(root: Path | None = None) -> Gradebook:
    """Everybody of `HOSTILE`, as identifier and as name, in every state."""
    makers = (good, bad, unreadable, not_graded)
    records = [
        makers[number % len(makers)](name, name=name, late=number % 3 == 0, source=f"{number}/{name}.py")
        for number, name in enumerate(HOSTILE)
    ]
    left = tuple((name, f"because of {name}") for name in HOSTILE)
    missing = tuple((name, ROBOT.id) for name in HOSTILE)
    return book(*records, exercises=(SERVICE, ROBOT), left=left, missing=missing, root=root)


def large_book(count: int, root: Path | None = None) -> Gradebook:
    """A class of so many, for each exercise a mixture."""
    chance = random.Random(1)  # noqa: S311 - an example
    makers = (good, good, good, bad, bad, unreadable)
    records = [
        chance.choice(makers)(f"student{number:05}", of=of, size=chance.randrange(500, 5000))
        for number in range(count)
        for of in (SERVICE, ROBOT)
    ]
    return book(*records, exercises=(SERVICE, ROBOT), root=root)

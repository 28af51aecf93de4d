"""Whom an instructor has to look at: what stands first on the class page."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from course_kit.classroom.exports.texts import describe_problem, format_number, group_by_student, name_of, score_of
from course_kit.classroom.records import outcome_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from course_kit.classroom.records import Gradebook, GradeRecord

_NOT_PASSED = ("crashed", "unreadable", "not passed")  # outcomes, what an instructor wants to see first in front


class StudentLabel(NamedTuple):
    """What to call a student: by name, and by identifier, too, where two have the same name."""

    name: str
    identifier: str = ""

    def __str__(self) -> str:
        return f"{self.name} ({self.identifier})" if self.identifier else self.name


@dataclass(frozen=True)
class ListedStudent:
    """Somebody in a list, with what there is to say and, where there is a report, its record."""

    called: StudentLabel
    told: str = ""
    record: GradeRecord | None = None


@dataclass(frozen=True)
class AttentionGroup:
    """People who need the same kind of attention."""

    id: str  # of the group on the page
    title: str  # what they have in common
    people: Sequence[ListedStudent]  # who they are
    advice: str = ""  # what to do about it; empty where that is plain
    urgent: bool = False  # whether it is unfolded from the beginning


def label_students(book: Gradebook) -> dict[str, StudentLabel]:
    """What to call each student; also those who handed in something that was not graded."""
    without = book.names
    records = group_by_student(book)
    names = {student: name_of(records[student], without.get(student, student)) for student in records}
    names.update((student, student) for student, _ in (*book.dropped, *book.odd, *book.unknown) if student not in names)
    shared = Counter(name.casefold() for name in names.values())
    return {
        student: StudentLabel(name, student if shared[name.casefold()] > 1 and name != student else "")
        for student, name in names.items()
    }


def group_by_attention(book: Gradebook, called: Mapping[str, StudentLabel]) -> list[AttentionGroup]:
    """Everybody to look at, the most urgent first; without groups nobody is in."""
    titles = {exercise.id: exercise.title for exercise in book.exercises}
    found = [
        AttentionGroup(
            "failed",
            "Could not be graded: an error of the grader",
            _of_records(
                book.not_graded, called, lambda record: f"{titles[record.entry.exercise]}: {describe_problem(record)}"
            ),
            "That is the grader's fault, not the students'. They have no grade, and are in no export. "
            "Run the same command again with --resume.",
            urgent=True,
        ),
        AttentionGroup(
            "dropped",
            "Handed in, but not graded",
            [ListedStudent(called[student], reason) for student, reason in book.dropped],
            "Check what these students handed in.",
            urgent=True,
        ),
        AttentionGroup(
            "doubtful",
            "Graded, but check the choice of file",
            _of_records(
                [record for record in book.records if record.entry.worry],
                called,
                lambda record: f"{record.entry.source}: {record.entry.worry}",
            ),
            "All choices, with their reasons, are in intake.csv.",
            urgent=True,
        ),
        AttentionGroup(
            "unknown",
            "Not matched with the roster",
            [ListedStudent(called[student], reason) for student, reason in book.unknown],
            "Graded, but not under a name of the roster.",
            urgent=True,
        ),
        AttentionGroup("missing", "Missing submissions", list(_lacks(book, called, titles))),
        *_errors(book, called, titles),
        AttentionGroup(
            "chosen",
            "One file was chosen among several",
            _of_records([record for record in book.records if record.entry.others], called, _choice),
        ),
        AttentionGroup(
            "odd",
            "Entries that do not fit the layout",
            [ListedStudent(called[student], reason) for student, reason in book.odd],
            "Graded, each entry as a separate student.",
        ),
        AttentionGroup(
            "late",
            "Handed in late",
            _of_records(
                [record for record in book.records if record.entry.late],
                called,
                lambda record: titles[record.entry.exercise],
            ),
        ),
    ]
    return [group for group in found if group.people]


def _of_records(
    records: Iterable[GradeRecord], called: Mapping[str, StudentLabel], explain: Callable[[GradeRecord], str]
) -> list[ListedStudent]:
    return [ListedStudent(called[record.entry.student], explain(record), record) for record in records]


def _lacks(book: Gradebook, called: Mapping[str, StudentLabel], titles: Mapping[str, str]) -> Iterator[ListedStudent]:
    """Each student once, with everything that is missing."""
    missing: dict[str, list[str]] = {}
    for student, exercise in book.missing:
        missing.setdefault(student, []).append(titles.get(exercise, exercise))
    for student, what in missing.items():
        missed = "everything" if len(what) == len(titles) > 1 else ", ".join(what)
        yield ListedStudent(called[student], missed)


def _errors(book: Gradebook, called: Mapping[str, StudentLabel], titles: Mapping[str, str]) -> Iterator[AttentionGroup]:
    """Who did not pass, by exercise: those whose program could not run at all in front, then by points."""
    for exercise in book.exercises:
        records = [record for record in book.records_of(exercise.id) if outcome_of(record) in _NOT_PASSED]
        records.sort(key=lambda record: (_NOT_PASSED.index(outcome_of(record)), score_of(record) or 0.0))
        people = _of_records(records, called, _how_it_went)
        yield AttentionGroup(f"not-passed-{exercise.id}", f"{titles[exercise.id]}: did not pass", people)


def _how_it_went(record: GradeRecord) -> str:
    state = outcome_of(record)
    points = f"{format_number(score_of(record) or 0.0)} of {format_number(record.max_score)}"
    return points if state == "not passed" else f"{state}, {points}"


def _choice(record: GradeRecord) -> str:
    """The file, why it, and what else there was."""
    entry = record.entry
    return f"{entry.source}: {entry.why}. Not: {'; '.join(entry.others)}"

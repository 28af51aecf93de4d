"""What is known of the submissions of a class, and the folder that keeps it: one file each, written atomically.

What counts of a submission stands in its record, and nowhere else: `score`, `passed`, `has_grade`, `is_late` and
`remarks` are those after lateness, penalty and override; `graded_score` is that of the checks.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import msgspec

from course_kit.classroom.rules.adjustments import Adjustment, describe_adjustment
from course_kit.environment import write_atomically
from course_kit.grading.model.plain_data import convert_record
from course_kit.text.sanitize import make_encodable

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator
    from pathlib import Path

    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.reading import Reader

FORMAT_VERSION = 1
STUDENTS = "students"  # folder in the output folder: students/<student>/<exercise>.json and .html
SUPERSEDED = "superseded"  # beside it, results that no longer count: superseded/<student>/<exercise>.<number>.json
_UNSAFE = re.compile(r"[^\w.@+-]+")
_LONGEST_NAME = 120  # bytes; a file system takes 255
_LONGEST_PLAIN = 80  # characters
_MARK = 16  # hexadecimal digits
_MARKED = re.compile(rf"-[0-9a-f]{{{_MARK}}}\Z")


@dataclass(frozen=True)
class Entry:
    """A submission as it was handed in."""

    student: str  # who, as the learning platform names them: a login, a number; with Moodle the full name
    exercise: str  # the exercise's id
    source: str  # path in the folder or archive that was handed over, with forward slashes
    name: str = ""  # the person's name where the layout tells it
    late: bool = False  # whether the platform marked it as late
    # what else the layout or the roster tells: `canvas_user`, `canvas_submission`, `moodle_participant`, `login`,
    # `sid`, `email`, `group`, `submitted_at`
    platform: dict[str, str] = field(default_factory=dict)
    why: str = ""  # why this file was chosen
    others: list[str] = field(default_factory=list)  # what else of theirs might have been, and why it was not
    worry: str = ""  # why somebody should look at the choice; empty when there is no doubt

    @property
    def label(self) -> str:
        """The student in a sentence: `4711 Jane Doe`, or the identifier alone where it is the name."""
        return f"{self.student} {self.name}" if self.name and self.name != self.student else self.student


class _Points(msgspec.Struct):
    """What counts of a report."""

    score: float
    max_score: float


@dataclass(frozen=True)
class GradeRecord:
    """The result of one submission, and what the instructor has made of it; only the result is stored."""

    entry: Entry  # what was handed in
    digest: str  # SHA-256 of the submission's bytes, hexadecimal; empty where they could not be read
    size: int  # of the submission's program, in bytes; of its file where it has none that can be read
    seed: int | None  # what the checks drew from
    report: dict[str, Any]  # the report as `Report.to_mapping` gives it
    title: str = ""  # the exercise's title
    isolation: str = ""  # what kept the submission apart from the machine, in one line
    wall_s: float = 0.0  # how long the grading took, in seconds
    same_as: str = ""  # the student whose identical submission was graded in its place; empty when this one was graded
    # of what graded it: `kit`, `exercise` and `grader`; empty in records of earlier kits
    versions: dict[str, str] = field(default_factory=dict)
    # lateness, penalty, override and comment; a gradebook adds it
    adjustment: Adjustment = field(default_factory=Adjustment)

    @property
    def graded_score(self) -> float:
        """What the checks gave."""
        return float(self.report["score"])

    @property
    def score(self) -> float:
        """The points that count: the checks', less the penalty, with those added; or what the instructor has set."""
        return self.adjustment.score(self.graded_score, self.max_score)

    @property
    def passed(self) -> bool:
        """Whether the points that count reach the pass mark."""
        mark = self.adjustment.pass_mark
        return bool(self.report["passed"]) if mark is None else self.has_grade and self.score >= mark

    @property
    def has_grade(self) -> bool:
        """Whether there is a grade: not where the grader itself failed, unless the instructor has set one."""
        return self.status != "error" or self.adjustment.override is not None

    @property
    def is_late(self) -> bool:
        """Whether it counts as late; without a due date the platform's mark says so."""
        return self.adjustment.late or (self.adjustment.due is None and self.entry.late)

    @property
    def remarks(self) -> list[str]:
        """What the student reads about lateness, penalty, override and comment, a sentence each."""
        return list(describe_adjustment(self.adjustment, None if self.status == "error" else self.graded_score))

    @property
    def max_score(self) -> float:
        """Full marks."""
        return float(self.report["max_score"])

    @property
    def status(self) -> str:
        """The report's status: graded, unreadable, crashed or error."""
        return str(self.report["status"])

    @property
    def diagnoses(self) -> list[str]:
        """Codes of the failed checks, each once, in the order of the checks."""
        codes = (check["diagnosis"] for check in self.report["checks"] if check["status"] == "failed")
        return list(dict.fromkeys(code for code in codes if code))

    def to_json(self) -> str:
        """The record as one JSON document."""
        stored = {part.name: getattr(self, part.name) for part in fields(self) if part.name != "adjustment"}
        stored["entry"] = vars(self.entry)
        return make_encodable(json.dumps({"format_version": FORMAT_VERSION, **stored}, indent=1, ensure_ascii=False))

    @classmethod
    def from_json(cls, text: str) -> GradeRecord:
        """The inverse of `to_json`."""
        values = json.loads(text)
        if not isinstance(values, dict) or values.pop("format_version", None) != FORMAT_VERSION:
            raise ValueError("it is no record of this version of the course kit")
        found = convert_record(values, cls)
        convert_record(found.report, _Points)
        return found


class RecordFolder:
    """The records in an output folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / STUDENTS
        self._superseded = folder / SUPERSEDED

    def path(self, entry: Entry, suffix: str = ".json") -> Path:
        """Where a submission's record or report (`.html`) stands."""
        return self.folder / safe_name(entry.student) / f"{entry.exercise}{suffix}"

    def keep(self, record: GradeRecord, page: str | None = None) -> None:
        """Write a record and its report page; the page first, so that a record that is there is complete."""
        if page is not None:
            before = self.find(record.entry)
            if before is not None and before.status != "error":
                self._copy_superseded(self.path(record.entry))
            write_atomically(self.path(record.entry, ".html"), page)
        write_atomically(self.path(record.entry), record.to_json() + "\n")

    def find(self, entry: Entry) -> GradeRecord | None:
        """The record of a submission if there is one that can be read."""
        return _read(self.path(entry))

    def list_stray_records(self, entries: Iterable[Entry], exercises: Collection[str]) -> list[Path]:
        """Where results stand that belong to none of these submissions."""
        here = {self.path(entry) for entry in entries}
        found = sorted(self.folder.glob("*/*.json"))
        return [path for path in found if path not in here and path.stem in exercises]

    def supersede(self, path: Path) -> GradeRecord | None:
        """Move a result, and its page, to `superseded`; returns it if it can be read."""
        record = _read(path)
        self._copy_superseded(path)
        path.unlink(missing_ok=True)  # first: if the run stops in between, a page without a record is ignored
        path.with_suffix(".html").unlink(missing_ok=True)
        with suppress(OSError):  # there are results for other exercises
            path.parent.rmdir()
        return record

    def remove_pages_alone(self) -> None:
        """Take away pages whose record was never written, as the run was killed between the two."""
        for page in self.folder.glob("*/*.html"):
            if not page.with_suffix(".json").exists():
                page.unlink(missing_ok=True)
                with suppress(OSError):
                    page.parent.rmdir()

    def _copy_superseded(self, path: Path) -> None:
        """Copy a result; once, should a run have ended between copying it and whatever takes its place."""
        content = path.read_bytes()
        folder = self._superseded / path.parent.name
        number = 1
        while (copy := folder / f"{path.stem}.{number}.json").exists():
            if copy.read_bytes() == content:
                return
            number += 1
        with suppress(FileNotFoundError):
            write_atomically(copy.with_suffix(".html"), path.with_suffix(".html").read_bytes())
        write_atomically(copy, content)

    def __iter__(self) -> Iterator[GradeRecord]:
        for path in sorted(self.folder.glob("*/*.json")):
            if (record := _read(path)) is not None:
                yield record


def _read(path: Path) -> GradeRecord | None:
    try:
        return GradeRecord.from_json(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def safe_name(student: str) -> str:
    """A folder's name for a student: readable, legal everywhere, and different for different students."""
    plain = _UNSAFE.sub("_", student).strip("._")[:_LONGEST_PLAIN]
    plain = plain.encode(errors="replace")[:_LONGEST_NAME].decode(errors="ignore")
    # Nobody may be called like somebody else's name with its mark.
    if plain == student and plain.lower() == plain and not _MARKED.search(plain):
        return plain
    return f"{plain}-{hashlib.sha256(student.encode(errors='surrogatepass')).hexdigest()[:_MARK]}"


@dataclass(frozen=True)
class Gradebook:
    """The results of a class run."""

    exercises: tuple[Exercise, ...]  # the exercises that were set, in the order of the course
    records: tuple[GradeRecord, ...]  # one for each student and exercise that was handed in, by student and exercise
    missing: tuple[tuple[str, str], ...] = ()  # student and exercise of those who handed in something else only
    left: tuple[tuple[str, str], ...] = ()  # path and reason of each file that is no submission
    layout: str = ""  # the layout the submissions were in
    seed: int = 0  # what the checks drew from
    complete: bool = True  # whether every submission has its record; False after Ctrl-C
    root: Path | None = None  # the folder the entries' sources are relative to; None where they are not at hand
    reader: Reader | None = None  # who has read them, and remembers; None where nobody has
    odd: tuple[tuple[str, str], ...] = ()  # student and reason of those whose entry does not fit the layout
    # student and reason of those who handed in something of which nothing could be graded, or not all
    dropped: tuple[tuple[str, str], ...] = ()
    # identifier and name of those on the roster who handed in nothing; they are among `missing`, too
    absent: tuple[tuple[str, str], ...] = ()
    unknown: tuple[tuple[str, str], ...] = ()  # student and reason of those who do not match the roster
    earlier: frozenset[str] = (
        frozenset()
    )  # ids of the exercises that an earlier run has graded: their files are elsewhere
    canvas_assignments: tuple[str, ...] = ()  # see `Roster`
    others: tuple[Entry, ...] = ()  # who has no submission at all, in entries without exercise and source

    @property
    def entries(self) -> tuple[Entry, ...]:
        """What everybody handed in, and who handed in nothing."""
        return (*(record.entry for record in self.records), *self.others)

    @property
    def names(self) -> dict[str, str]:
        """The names of those without a submission, by student."""
        return {other.student: other.name for other in self.others if other.name}

    @property
    def students(self) -> list[str]:
        """Everybody who handed in anything, sorted."""
        return sorted({record.entry.student for record in self.records} | {student for student, _ in self.missing})

    def graded_records(self, exercise_id: str | None = None) -> list[GradeRecord]:
        """The records that hold a grade, of one exercise or of all; see `GradeRecord.has_grade`."""
        records = self.records if exercise_id is None else self.records_of(exercise_id)
        return [record for record in records if record.has_grade]

    @property
    def not_graded(self) -> list[GradeRecord]:
        """The records of submissions that have to be graded again, as the grader itself failed."""
        return [record for record in self.records if not record.has_grade]

    def records_of(self, exercise_id: str) -> list[GradeRecord]:
        """The records of one exercise, by student."""
        return [record for record in self.records if record.entry.exercise == exercise_id]

    def tally(self) -> Counter[str]:
        """How many passed, did not pass, crashed, were unreadable, or met an error of the grader."""
        return Counter(outcome_of(record) for record in self.records)


def outcome_of(record: GradeRecord) -> str:
    """A record in a word or two: passed, not passed, crashed, unreadable or error."""
    if record.status == "graded" or record.passed or record.adjustment.override is not None:
        return "passed" if record.passed else "not passed"
    return record.status

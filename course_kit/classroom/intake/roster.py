"""A class list as a learning platform exports it, or any other: who is in the class, by which names and numbers."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_kit.classroom.intake import roster_columns as columns
from course_kit.classroom.intake.roster_columns import plain
from course_kit.grading.errors import GradingError
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from pathlib import Path

_LARGEST = 20 * 1024**2  # bytes
_ASSIGNMENT = re.compile(r".+ \(\d+\)")
_DELIMITERS = ",;\t|"
_TEST_STUDENT = "student, test"  # Canvas's own, with which instructors try things
_NO_STUDENT = "points possible"  # the second row of Canvas's gradebook
_IDENTIFIERS = (columns.LOGIN, columns.EMAIL, columns.NUMBER, columns.CANVAS, columns.GITHUB)
_PLATFORM = {  # see `Entry.platform`
    columns.CANVAS: "canvas_user",
    columns.NUMBER: "sid",
    columns.EMAIL: "email",
    columns.LOGIN: "login",
    columns.GITHUB: "github",
}


@dataclass(frozen=True)
class Person:
    """Somebody of the class."""

    name: str  # as people write it, first name first
    values: dict[str, str] = field(default_factory=dict)  # what the list says, by the kinds of `roster_columns`

    def student(self, layout: str) -> str:
        """What they are called where they have handed in nothing."""
        own = {"canvas": columns.CANVAS, "gradescope": columns.NUMBER, "github": columns.GITHUB}.get(layout, "")
        found = (self.values.get(kind, "") for kind in (own, *_IDENTIFIERS))
        return next((one for one in found if one), self.name)

    @property
    def platform(self) -> dict[str, str]:
        """What platforms call them, see `Entry.platform`."""
        return {key: self.values[kind] for kind, key in _PLATFORM.items() if self.values.get(kind)}


@dataclass(frozen=True)
class Roster:
    """A class list."""

    called: str  # the file's name
    people: tuple[Person, ...]  # who is in the class
    # each column's header and what it was taken for; those that were not used are left out
    read_as: tuple[tuple[str, str], ...]
    path: Path | None = None  # the file
    # the assignments of Canvas's gradebook, as its import has to call them: "Title (number)"
    canvas_assignments: tuple[str, ...] = ()


def read(path: Path) -> Roster:
    """Read a class list: of Canvas, Moodle, nbgrader, or any CSV with names or identifiers."""
    rows = [row for row in _rows(path) if any(cell.strip() for cell in row)]
    if not rows:
        raise GradingError(f"{path} is empty. --roster has to name a list of students, as CSV.")
    header = rows[0] if columns.has_header(rows[0]) else [f"column {place}" for place in range(1, len(rows[0]) + 1)]
    body = rows[1:] if header is rows[0] else rows
    kinds = columns.guess(header, body)
    if not {columns.FULL, columns.LAST, columns.FIRST, columns.MOODLE, *_IDENTIFIERS} & set(kinds):
        raise GradingError(
            f"Nothing in {path} looks like names, e-mail addresses or student numbers. Its columns are: "
            f"{', '.join(one_line(one) for one in header[:20])}. Give them headers such as 'name', 'email' or 'login'."
        )
    people = [person for row in body if (person := _person(row, kinds)) is not None]
    if not people:
        raise GradingError(f"{path} lists nobody.")
    read_as = tuple((one_line(head), kind) for head, kind in zip(header, kinds, strict=True) if kind)
    found = [head.strip() for head in header if _ASSIGNMENT.fullmatch(head.strip())] if columns.CANVAS in kinds else []
    return Roster(path.name, _once(people), read_as, path, tuple(found))


def _rows(path: Path) -> list[list[str]]:
    try:
        with path.open("rb") as file:
            data = file.read(_LARGEST + 1)
    except OSError as problem:
        raise GradingError(f"{path} could not be read: {problem.strerror}.") from problem
    if len(data) > _LARGEST:
        raise GradingError(f"{path} is larger than {_LARGEST // 1024**2} MB. --roster has to name a list of students.")
    text = _decoded(data)
    first = text.lstrip().split("\n", 1)[0]
    delimiter = max(_DELIMITERS, key=first.count)
    try:
        return list(csv.reader(text.splitlines(keepends=True), delimiter=delimiter))
    except csv.Error as problem:
        raise GradingError(f"{path} is not a CSV file: {problem}.") from problem


def _decoded(data: bytes) -> str:
    """A text as Excel and learning platforms save it."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")


def _person(row: list[str], kinds: list[str]) -> Person | None:
    """Who a row is; None where it is nobody."""
    values = {kind: one_line(cell) for cell, kind in zip(row, kinds, strict=False) if kind and cell.strip()}
    if (number := columns.participant(values.get(columns.MOODLE, ""))) or columns.MOODLE in values:
        values[columns.MOODLE] = number
    full = values.get(columns.FULL, "")
    if plain(full) == _NO_STUDENT or full.casefold() == _TEST_STUDENT:
        return None
    last, comma, first = full.partition(",")
    name = f"{first.strip()} {last.strip()}" if comma else full
    if not name:
        name = " ".join(filter(None, (values.get(columns.FIRST, ""), values.get(columns.LAST, ""))))
    if not name and not any(values.get(kind) for kind in (*_IDENTIFIERS, columns.MOODLE)):
        return None
    return Person(name.strip(), values)


def _once(people: list[Person]) -> tuple[Person, ...]:
    """Everybody once, who may be listed in two sections."""
    found: dict[tuple[str, ...], Person] = {}
    for person in people:
        key = tuple(person.values.get(kind, "") for kind in (*_IDENTIFIERS, columns.MOODLE))
        found.setdefault((*key, "" if any(key) else person.name, person.values.get(columns.GROUP, "")), person)
    return tuple(found.values())

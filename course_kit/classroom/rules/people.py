"""Small CSV tables that an instructor writes: reports each mistake with its line; finds whom a line means."""

from __future__ import annotations

import csv
import io
import sys
from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Generic, TypeVar

from course_kit.grading.errors import GradingError
from course_kit.ros.names import did_you_mean
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from course_kit.classroom.records import Entry

_DELIMITERS = ",;\t"  # the second is what spreadsheets write where the comma stands within numbers
_MOST_TOLD = 20
Said = TypeVar("Said")
# What tells who somebody is, of `Entry.platform`; the rest tells which submission, assignment or group.
_IDENTIFIERS = ("login", "email", "sid", "github", "canvas_user", "moodle_participant")


@dataclass(frozen=True)
class TableRow:
    """One line of a table: its number in the file, and its cells by column, without blanks around them."""

    line: int
    cells: Mapping[str, str]


@dataclass
class Mistakes:
    """What is wrong with a file; collected, and reported together."""

    path: Path
    found: list[tuple[int, str]] = field(default_factory=list)

    def add(self, line: int, what: str) -> None:
        """Note a mistake of one line, once."""
        noted = (line, f"line {line}: {what}")
        if noted not in self.found:
            self.found.append(noted)

    def add_of_all(self, what: str) -> None:
        """Note a mistake of the whole file."""
        self.found.append((sys.maxsize, what))

    def __str__(self) -> str:
        lines = [what for _, what in sorted(self.found, key=lambda mistake: mistake[0])]
        more = len(lines) - _MOST_TOLD
        lines = [*lines[:_MOST_TOLD], *([f"and {more} more"] if more > 0 else [])]
        return f"{self.path} cannot be used. Correct it, then run this again:\n  " + "\n  ".join(lines)


def require_none(files: Iterable[Mistakes]) -> None:
    """Tell what is wrong with some files, all of it at once."""
    if wrong := [file for file in files if file.found]:
        raise GradingError("\n".join(map(str, wrong)))


def read_rows(
    path: Path, required: Sequence[str], optional: Sequence[str] = (), *, headless: bool = False
) -> list[TableRow]:
    """Read a table; empty lines are left out."""
    text = _text(path)
    first = text.partition("\n")[0]
    delimiter = max(_DELIMITERS, key=first.count)
    if headless and first.strip().rpartition(delimiter)[2].strip(' "').isdecimal():
        text = f"{delimiter.join(required)}\n{text}"
        lines_before = 1
    else:
        lines_before = 0
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    mistakes = Mistakes(path)
    rows: list[TableRow] = []
    try:
        header = [cell.strip().lower() for cell in next(reader, [])]
        if missing := [column for column in required if column not in header]:
            mistakes.add(1, f"the column {_quote(missing)} is missing; it needs {_quote([*required, *optional])}")
            require_none([mistakes])
        wanted = {column: header.index(column) for column in (*required, *optional) if column in header}
        before = reader.line_num
        for cells in reader:
            if any(cell.strip() for cell in cells):
                found = dict.fromkeys((*required, *optional), "")
                found |= {column: cells[at].strip() for column, at in wanted.items() if at < len(cells)}
                rows.append(TableRow(before + 1 - lines_before, found))
            before = reader.line_num
    except csv.Error as problem:
        mistakes.add(reader.line_num, str(problem))
    require_none([mistakes])
    return rows


def _text(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8-sig")
    except OSError as problem:
        raise GradingError(f"{path} could not be read: {problem.strerror}.") from problem
    except UnicodeDecodeError as problem:
        raise GradingError(f"{path} is not UTF-8. Save it as CSV in UTF-8.") from problem


def parse_number(text: str) -> float | None:
    """A number as people write it, `7.5` or `7,5`; None when it is none."""
    plain = text.replace(",", ".") if text.count(",") == 1 and "." not in text else text
    if not plain.replace(".", "", 1).lstrip("+-").isdecimal():
        return None
    return float(plain)


def describe_unknown(what: str, name: str, known: Iterable[str]) -> str:
    """`there is no student 'bo'. Did you mean 'bob'?`."""
    return f"there is no {what} '{one_line(name)}' here.{did_you_mean(name, list(known))}"


def _quote(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)


class People:
    """Everybody of a class: a student by any name of the reports, the class list or a platform, or a whole group."""

    def __init__(self, entries: Iterable[Entry]) -> None:
        self.students: set[str] = set()
        self._names: set[str] = set()  # as they are written
        self._called: dict[str, set[str]] = defaultdict(set)
        self._groups: dict[str, set[str]] = defaultdict(set)
        for entry in entries:
            self.students.add(entry.student)
            for name in (entry.student, entry.name, *(entry.platform.get(key, "") for key in _IDENTIFIERS)):
                if name:
                    self._names.add(name)
                    self._called[name.casefold()].add(entry.student)
            if group := entry.platform.get("group"):
                self._names.add(group)
                self._groups[group.casefold()].add(entry.student)

    def students_called(self, called: str) -> list[str]:
        """The student who is called so, as the reports call them, or all of a group."""
        if called in self.students:
            return [called]
        found = sorted(self._called.get(called.casefold(), ()))
        if not found and (group := self._groups.get(called.casefold())):
            return sorted(group)
        if not found:
            raise ValueError(describe_unknown("student", called, self._names))
        if len(found) > 1:
            raise ValueError(
                f"several are called '{one_line(called)}': {', '.join(found)}. Write one of these, as in grades.csv"
            )
        return found


@dataclass(frozen=True)
class StudentTable(Generic[Said]):
    """What a file says of students, by what it calls them and by exercise, each with its line."""

    mistakes: Mistakes
    said: dict[tuple[str, str], tuple[Said, int]] = field(default_factory=dict)

    def put(self, row: TableRow, exercise: str, said: Said) -> None:
        """Note what a line says of its student."""
        student = row.cells["student"]
        if not student:
            self.mistakes.add(row.line, "the student is missing")
        elif (student, exercise) in self.said:
            who = f"{student} and {exercise} stand" if exercise else f"{student} stands"
            self.mistakes.add(row.line, f"{who} in line {self.said[student, exercise][1]} already")
        else:
            self.said[student, exercise] = (said, row.line)

    def find(self, student: str, exercise: str = "") -> Said | None:
        """What it says of a student; None where it says nothing."""
        found = self.said.get((student, exercise))
        return None if found is None else found[0]

    def match_people(self, people: People) -> StudentTable[Said]:
        """The same by the students of a class, called by any of their names; whoever is not in it is a mistake."""
        found: StudentTable[Said] = StudentTable(Mistakes(self.mistakes.path, [*self.mistakes.found]))
        for (called, exercise), (value, line) in self.said.items():
            try:
                meant = people.students_called(called)
            except ValueError as problem:
                found.mistakes.add(line, str(problem))
                continue
            for student in meant:
                _, before = found.said.setdefault((student, exercise), (value, line))
                if before != line:
                    found.mistakes.add(line, f"{called} is {student}, who stands in line {before} already")
        return found

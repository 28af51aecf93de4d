"""Whom the instructor means: a student by any name of the reports, the class list or a platform, or a whole group.

What a student is called in the reports may change, from the address on the class list to a platform's number once they
hand something in. What the instructor has written about them stays theirs.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, TypeVar

from course_kit.classroom.rules.tables import unknown
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Iterable

    from course_kit.classroom.records import Entry
    from course_kit.classroom.rules.tables import Mistakes

Said = TypeVar("Said")
# What tells who somebody is, of `Entry.platform`; the rest tells which submission, assignment or group.
_IDENTIFIERS = ("login", "email", "sid", "github", "canvas_user", "moodle_participant")


class People:
    """Everybody of a class."""

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

    def by_student(
        self, lines: Iterable[tuple[int, str, str, Said]], mistakes: Mistakes, twice: str
    ) -> dict[tuple[str, str], tuple[Said, int]]:
        """What the lines of a file say, with their numbers, by student and exercise."""
        found: dict[tuple[str, str], tuple[Said, int]] = {}
        for line, called, exercise, said in lines:
            try:
                meant = self._students(called)
            except ValueError as problem:
                mistakes.add(line, str(problem))
                continue
            for student in meant:
                _, before = found.setdefault((student, exercise), (said, line))
                if before != line:
                    mistakes.add(line, twice.format(called=called, student=student, exercise=exercise, line=before))
        return found

    def _students(self, called: str) -> list[str]:
        """The student who is called so, as the reports call them, or all of a group."""
        if called in self.students:
            return [called]
        found = sorted(self._called.get(called.casefold(), ()))
        if not found and (group := self._groups.get(called.casefold())):
            return sorted(group)
        if not found:
            raise ValueError(unknown("student", called, self._names))
        if len(found) > 1:
            raise ValueError(
                f"several are called '{one_line(called)}': {', '.join(found)}. Write one of these, as in grades.csv"
            )
        return found

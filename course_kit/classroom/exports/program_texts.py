"""The programs of a class as the exports need them: each is read when it is asked for, if nobody has read it yet."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.grading.reading_answers import Fingerprints
from course_kit.grading.readings import Readings
from course_kit.grading.submission import Copy, UnreadableError
from course_kit.process import Closing

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record
    from course_kit.grading.exercise import Exercise


class ProgramTexts(Closing):
    """Reads them, while the submissions are at hand; for one thread."""

    def __init__(self, book: Gradebook) -> None:
        self._root, self._elsewhere = book.root, book.earlier
        self._exercises = {one.id: one for one in book.exercises}
        self._readings = Readings() if book.readings is None else book.readings.remembered()
        self._lines: dict[str, list[str]] = {}

    @property
    def are_at_hand(self) -> bool:
        """Whether there is anything to read."""
        return self._root is not None

    def fingerprints(self, record: Record) -> Fingerprints:
        """Those of a submission; none of what cannot be read."""
        if self._root is None or record.status == "unreadable" or record.entry.exercise in self._elsewhere:
            return Fingerprints()
        return self.of_file(self._root / record.entry.source, self._exercises[record.entry.exercise])

    def of_file(self, path: Path, exercise: Exercise) -> Fingerprints:
        """The fingerprints of any file that is read as a submission for an exercise."""
        with suppress(UnreadableError, GradingError), Copy(path) as copy:
            return self._readings.fingerprints(copy, exercise)
        return Fingerprints()

    def lines(self, record: Record) -> list[str]:
        """A program's lines; none of what cannot be read."""
        source = f"{record.entry.exercise}/{record.entry.source}"
        if source not in self._lines:
            self._lines[source] = self._read(record)
        return self._lines[source]

    def close(self) -> None:
        """End the process that reads. Safe to call twice."""
        self._readings.close()

    def _read(self, record: Record) -> list[str]:
        if self._root is not None and record.entry.exercise not in self._elsewhere:
            with suppress(UnreadableError, GradingError), Copy(self._root / record.entry.source) as copy:
                return self._readings.read(copy, self._exercises[record.entry.exercise]).source.split("\n")
        return []

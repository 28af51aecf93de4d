"""A reader that remembers: what it has read of a file while that was looked at, it need not read again."""

from __future__ import annotations

from array import array
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.grading.reading.reader import Reader
from course_kit.grading.reading.reading_answers import Fingerprints
from course_kit.process import Closable
from course_kit.reader import fingerprints, text

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.submission import Copy, Submission
    from course_kit.grading.reading.reading_answers import Glance, Look

_MOST_CHARACTERS = 64 << 20  # of all programs together that are remembered; 10,000 ordinary ones have 20 million


@dataclass(frozen=True)
class _Known:
    """What was read of a file; the fingerprints packed, as a set of numbers takes ten times as much."""

    program: Submission
    identity: str
    prints: array[int]


class _Memory:
    """What has been read, by the file's name and bytes and the exercise."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, str, str], _Known] = {}
        self._characters = 0

    def find(self, copy: Copy, exercise: Exercise) -> _Known | None:
        return self._known.get((copy.name, copy.digest, exercise.id))

    def keep(self, copy: Copy, exercise: Exercise, program: Submission, found: Fingerprints) -> None:
        if self._characters < _MOST_CHARACTERS:
            packed = array("Q", found.prints)
            self._known[copy.name, copy.digest, exercise.id] = _Known(program, found.identity, packed)
            self._characters += len(program.source)


class Readings(Closable):
    """Does what `Reader` does, and raises what that raises. Its process runs while it has something to read."""

    def __init__(self, stopped: Callable[[], bool] = lambda: False, *, memory: _Memory | None = None) -> None:
        """Get ready; no process runs yet."""
        self._stopped = stopped
        self._memory = memory or _Memory()
        self._reader: Reader | None = None

    def remembered(self, stopped: Callable[[], bool] = lambda: False) -> Readings:
        """Another one that remembers the same, with a process of its own; `stopped` as of a new one."""
        return Readings(stopped, memory=self._memory)

    def glance(self, copy: Copy, exercise: Exercise) -> Glance:
        """What a file looks like; what the exercise asks for is read and remembered."""
        return self._look(copy, exercise, whatever=False).glance

    def read(self, copy: Copy, exercise: Exercise) -> Submission:
        """The program that somebody has handed in for an exercise."""
        known = self._memory.find(copy, exercise)
        return self._started().read(copy, exercise) if known is None else known.program

    def fingerprints(self, copy: Copy, exercise: Exercise) -> Fingerprints:
        """The fingerprints of a submission."""
        known = self._memory.find(copy, exercise)
        if known is None:
            return self._look(copy, exercise, whatever=True).fingerprints
        return Fingerprints(known.identity, frozenset(known.prints))

    def _look(self, copy: Copy, exercise: Exercise, *, whatever: bool) -> Look:
        look = self._started().look(copy, exercise, whatever=whatever)
        if look.program is not None:
            self._memory.keep(copy, exercise, look.program, look.fingerprints)
        return look

    def close(self) -> None:
        """End the process; what is remembered stays, and a process starts again for what is not. Safe to call twice."""
        reader, self._reader = self._reader, None
        if reader is not None:
            reader.close()

    def _started(self) -> Reader:
        if self._reader is None:
            self._reader = Reader(self._stopped)
        return self._reader


def starter_identities(exercise: Exercise) -> frozenset[str]:
    """Those of the programs that an exercise begins with: whoever hands one in as it was has not begun."""
    found = set()
    for name in (exercise.starter, exercise.notebook):
        # One that is not there, or a notebook without a cell to fill in, was given to nobody.
        with suppress(OSError, text.UnreadableTextError), (exercise.folder / name).open("rb") as file:
            found.add(fingerprints.program_identity(text.read_program(name, file, exercise.id)[0]))
    return frozenset(found)

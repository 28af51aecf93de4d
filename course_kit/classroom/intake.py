"""Finds the submissions in what an instructor has downloaded; whatever is not one is listed, never dropped.

An entry that is broken, or named like nothing else, is its own problem: everybody else's submissions are found.
"""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom import arrangement, listing, students
from course_kit.classroom.archive import Archive
from course_kit.classroom.records import Entry
from course_kit.grading.errors import GradingError
from course_kit.grading.reading import Reader
from course_kit.grading.submission import Copy, UnreadableError
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from course_kit.classroom.layouts import Unit
    from course_kit.classroom.listing import Item, Left, Listing
    from course_kit.grading.exercise import Exercise

_NAMED, _CALLED_ALIKE, _BY_CONTENT, _ONLY_ONE = 4, 3, 2, 1  # how sure it is that a file is for an exercise
_MOST_OPENED = 200  # files of one student into which is looked for what they are for
_MOST_LISTED = 50  # files of one student that are listed one by one
_MOST_TOLD = 3  # problems of one student in a sentence
_NOT_FOUND = "none of it belongs to these exercises"


@dataclass(frozen=True)
class Intake:
    """What was handed in.

    Attributes:
        root: the folder the entries' sources are relative to.
        layout: the name of the layout that was recognised.
        entries: the submissions, by student and exercise.
        left: path and reason of every file that is none.
        missing: student and exercise of whoever handed in something else only.
        odd: student and reason of those whose entry does not fit the layout; they are graded like everybody.
        dropped: student and reason of those who handed in something and have no submission at all, or have one that
            cannot be had.
    """

    root: Path
    layout: str
    entries: tuple[Entry, ...]
    left: tuple[tuple[str, str], ...]
    missing: tuple[tuple[str, str], ...]
    odd: tuple[tuple[str, str], ...] = ()
    dropped: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class _File:
    """One file of a student; `problem` says why it cannot be had."""

    item: Item
    unit: Unit
    problem: str = ""

    @property
    def path(self) -> str:
        return self.item.path

    @property
    def called(self) -> str:
        """What the student called it."""
        return (self.item is self.unit.item and self.unit.file) or self.item.name


@dataclass(frozen=True)
class _Candidate:
    file: _File
    sureness: int
    changed: float

    @property
    def rank(self) -> tuple[int, int, float, str]:
        return (self.sureness, self.file.unit.attempt, self.changed, self.file.path)


def collect(
    source: Path,
    exercises: Sequence[Exercise],
    workspace: Path,
    layout: str = arrangement.AUTO,
    stopped: Callable[[], bool] = lambda: False,
) -> Intake:
    """Find the submissions.

    For each student and exercise one file is taken: named like the starter or its notebook, else with the exercise's
    id in its name, else one that holds its class, variable or `%%submission` line; with a single exercise also a
    student's only program. Of several the surest, then the newest.

    Args:
        source: a folder or a zip.
        exercises: which exercises were set.
        workspace: where a zip is unpacked.
        layout: a name of `layouts.LAYOUTS`, or AUTO to recognise it.
        stopped: asked now and then whether to stop.

    Raises:
        GradingError: there is no such folder, zip or layout, it cannot be read, or there is nothing in it.
        ReadingStoppedError: somebody has asked to stop.
    """
    with ExitStack() as stack:
        root, found = _open(source, workspace, stack)
        called = source.resolve().name if root == source else source.stem
        try:
            arranged = arrangement.arrange(found, layout, called)
        except OSError as problem:
            raise GradingError(f"{source} cannot be read: {problem.strerror}.") from problem
        lost = found.lost if isinstance(found, Archive) else []
        left = [*arranged.left, *(found.left if isinstance(found, Archive) else [])]
        if not arranged.units and not left:
            raise GradingError(f"There are no files in {source}.")
        choice = _Choice(root, found, exercises, stack.enter_context(Reader(stopped)))
        for student, units in students.by_name(arranged.units, [one.id for one in exercises]).items():
            choice.take(student, units)
    return Intake(
        root,
        arranged.layout,
        entries=tuple(choice.entries),
        left=tuple(sorted([*left, *choice.left])),
        missing=tuple(choice.missing),
        odd=tuple(choice.odd),
        dropped=(*choice.dropped, *((one_line(path), reason) for path, reason in lost)),
    )


def _open(source: Path, workspace: Path, stack: ExitStack) -> tuple[Path, Listing]:
    try:
        if source.is_dir():
            return source, listing.Folder(source)
        is_file = source.is_file()
    except OSError as problem:  # a name that is too long, a folder around it that cannot be read
        raise GradingError(f"{source} cannot be read: {problem.strerror}.") from problem
    if is_file:
        return workspace, stack.enter_context(Archive(source, workspace))
    raise GradingError(f"There is no folder or zip file {source}.")


class _Choice:
    """Chooses each student's submissions, one student after the other."""

    def __init__(self, root: Path, found: Listing, exercises: Sequence[Exercise], reader: Reader) -> None:
        self._root = root
        self._reader = reader
        self._listing = found
        self._exercises = exercises
        self.entries: list[Entry] = []
        self.left: Left = []
        self.missing: list[tuple[str, str]] = []
        self.odd: list[tuple[str, str]] = []
        self.dropped: list[tuple[str, str]] = []

    def take(self, student: str, units: Sequence[Unit]) -> None:
        """Choose among a student's files."""
        if odd := next((unit.odd for unit in units if unit.odd), ""):
            self.odd.append((student, odd))
        files, problems = self._files(units)
        entries: list[Entry] = []
        reasons = dict(_unhad(files))
        lost = []
        for exercise in self._exercises:
            candidates = sorted(self._candidates(files, exercise), key=lambda one: one.rank)
            if not candidates:
                continue
            best = candidates[-1].file
            if best.problem:
                lost.append(f"{one_line(best.path)}: {best.problem}")
                why = f"{best.path} would have been used, but cannot be read"
            else:
                entries.append(_entry(student, exercise, best))
                why = f"{best.path} was used"
            reasons.update((one.file.path, why) for one in candidates if not one.file.problem)
        taken = {entry.source for entry in entries}
        rest = [(file.path, reasons.get(file.path, "it belongs to none of these exercises")) for file in files]
        self._leave(student, [one for one in rest if one[0] not in taken], "they belong to none of these exercises")
        handed_in = {entry.exercise for entry in entries}
        self.missing += [(student, exercise.id) for exercise in self._exercises if exercise.id not in handed_in]
        self.entries += entries
        if lost or (not entries and (files or problems)):
            self.dropped.append((student, _together(lost or problems) or _NOT_FOUND))

    def _files(self, units: Sequence[Unit]) -> tuple[list[_File], list[str]]:
        """All files of a student, and what kept some from being found."""
        files: list[_File] = []
        problems: list[str] = []
        for unit in units:
            found = listing.look_through(self._listing, unit.item)
            self._leave(unit.student, list(found.tools), "the same")
            self._leave(unit.student, list(found.unseen), "the same")
            problems += [f"{one_line(path)}: {reason}" for path, reason in found.unseen]
            files += [_File(item, unit, item.problem or _not_followed(item, unit)) for item in found.files]
            if not (found.files or found.tools or found.unseen):
                self.left.append((unit.item.path, "an empty folder"))
        wanted = [file for file in files if file.item.is_program or len(files) == 1]
        unpacked = self._listing.fetch(file.item for file in wanted if not file.problem)
        return [replace(file, problem=file.problem or unpacked.get(file.path, "")) for file in files], problems

    def _leave(self, student: str, rest: Left, others: str) -> None:
        """List files of a student; of a heap the first ones, and the number of the others with a reason."""
        self.left += rest[:_MOST_LISTED]
        if len(rest) > _MOST_LISTED:
            self.left.append((f"{len(rest) - _MOST_LISTED} more of {student}", others))

    def _candidates(self, files: list[_File], exercise: Exercise) -> Iterator[_Candidate]:
        programs = [file for file in files if file.item.is_program]
        alone = len(self._exercises) == 1 and (len(programs) == 1 or (not programs and len(files) == 1))
        for place, file in enumerate(programs or files):
            sureness = self._sureness(file, exercise, opened=place < _MOST_OPENED) or (_ONLY_ONE if alone else 0)
            if sureness:  # whatever it is, its student gets a report that says what is wrong with it
                yield _Candidate(file, sureness, _changed(self._root / file.path))

    def _sureness(self, file: _File, exercise: Exercise, *, opened: bool) -> int:
        if not file.item.is_program:
            return 0
        if file.called in (exercise.starter, exercise.notebook):
            return _NAMED
        if exercise.id in file.called.lower():
            return _CALLED_ALIKE
        can_be_opened = opened and not file.problem and file.item.kind == listing.FILE
        meant = can_be_opened and _is_meant_for(self._root / file.path, exercise, self._reader)
        return _BY_CONTENT if meant else 0


def _not_followed(item: Item, unit: Unit) -> str:
    """Why a student's own entry is not opened: a link may lead to anybody's work."""
    if item is not unit.item or item.kind == listing.FILE:
        return ""
    return "it is a link, and links are not followed" if item.kind == listing.LINK else "it is not an ordinary file"


def _together(problems: Sequence[str]) -> str:
    more = len(problems) - _MOST_TOLD
    return "; ".join(problems[:_MOST_TOLD]) + (f"; and {more} more" if more > 0 else "")


def _unhad(files: Sequence[_File]) -> Mapping[str, str]:
    return {file.path: file.problem for file in files if file.problem}


def _entry(student: str, exercise: Exercise, file: _File) -> Entry:
    unit = file.unit
    platform = {key: one_line(value) for key, value in unit.platform.items()}
    inside = file.path[len(unit.item.path) + 1 :]
    if unit.has_assignments and "/" in inside:
        platform["nbgrader_assignment"] = one_line(inside.partition("/")[0])
    return Entry(student, exercise.id, file.path, one_line(unit.name), unit.late, platform)


def _is_meant_for(path: Path, exercise: Exercise, reader: Reader) -> bool:
    """Whether a file holds what the exercise asks for."""
    try:
        copy = Copy(path, whole=False)
    except UnreadableError:
        return False
    with copy:
        try:
            return reader.mentions(copy, exercise)
        except (UnreadableError, GradingError):
            return True  # it may be; whoever reads it next says what is wrong with it


def _changed(path: Path) -> float:
    try:
        return path.lstat().st_mtime
    except OSError:
        return 0.0

"""`course-kit reset` and `solution`: what the course itself has written for an exercise.

Learners work in a folder of their own, so the files in `exercises/` are the starters.
"""

from __future__ import annotations

import os
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading import exercise
from course_kit.grading.errors import GradingError
from course_kit.learner import handed_out, progress, workspace
from course_kit.learner.workspace import read_starter, shown
from course_kit.text.console import cannot, tell

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from course_kit.grading.exercise import Exercise


@dataclass(frozen=True)
class Return:
    """A learner's file that is not the starter any more, or is gone."""

    file: Path
    starter: bytes

    @property
    def backup(self) -> Path:
        """The first free name beside the file; the highest number is the newest."""
        number = 1
        while os.path.lexists(free := self.file.with_name(f"{self.file.stem}.backup-{number}{self.file.suffix}")):
            number += 1
        return free

    def carry_out(self) -> Path | None:
        """Save what is there, then put the starter in its place; returns the backup, None where nothing was there.

        Raises:
            OSError: that could not be done; the learner's file is as it was.
        """
        saved = None
        if self.file.exists():
            saved = self.backup
            environment.files.write_new(saved, self.file.read_bytes())
            shutil.copystat(self.file, saved)
        environment.write_atomically(self.file, self.starter)
        return saved


def changed(task: Exercise, place: Path | None = None) -> list[Return]:
    """The starter files of an exercise that the learner has changed, or that are not there.

    Args:
        task: the exercise.
        place: the folder they are in, or one of the two files; the exercise's own folder when None.

    Raises:
        GradingError: a file cannot be read, or `place` is neither.
    """
    try:
        return list(_compare(task, _files(task, task.folder if place is None else place)))
    except OSError as problem:
        raise GradingError(f"{problem.filename} cannot be read: {problem.strerror}. Nothing was changed.") from None


def _compare(task: Exercise, files: Mapping[str, Path]) -> Iterator[Return]:
    for name, file in files.items():
        starter = read_starter(task.folder / name)
        content = starter if file.parent == task.folder else handed_out.as_handed_out(name, starter)
        if not file.exists() or file.read_bytes() not in (content, starter):
            yield Return(file, content)


def _files(task: Exercise, place: Path) -> dict[str, Path]:
    """Where each starter file belongs, by its name: both in a folder, or the one that a file's ending says."""
    if place.is_dir() or not place.suffix:
        return {name: place / name for name in (task.starter, task.notebook)}
    for name in (task.starter, task.notebook):
        if place.suffix == Path(name).suffix:
            return {name: place}
    raise GradingError(f"{place} is neither a .py nor an .ipynb file. Name your file, or the folder it is in.")


def reset(exercise_id: str, *, yes: bool, forget: bool, place: Path | None = None, folder: Path | None = None) -> int:
    """Put the starter back, after saving what is there, and ask before; 0 when done, 1 when the answer is no.

    Args:
        exercise_id: which exercise.
        yes: do not ask.
        forget: forget its progress, too.
        place: the learner's folder or file, which may not be there yet; found by `workspace` when None.
        folder: the folder of exercises, the course's own when None.

    Raises:
        GradingError: it could not be done, or there is nobody to ask.
    """
    task = exercise.load(exercise_id, folder)
    if place is None:
        place = task.folder if folder is not None else workspace.exercise_folder(task)
    if place is None and not forget:
        raise workspace.no_files_of(task, "reset")
    returns = [] if place is None else changed(task, place)
    if not returns and not forget and place is not None:
        if place == task.folder:
            where = environment.LEARNER_FOLDER
            print(f"The files in {shown(place)} are the starters themselves. Learners work in {where}/.")
        else:
            print(f"{task.id} already matches the starter: {shown(place)}")
        return 0
    nothing_to_lose = not forget and not any(each.file.exists() for each in returns)
    if not yes and not nothing_to_lose and not _agreed(returns, forget=forget):
        print("Nothing was changed.")
        return 1
    for each in returns:
        _carry_out(each)
    if returns:
        print("If it is open in JupyterLab: File > Reload from Disk.")
    if forget:
        return _forget(task)
    return 0


def _agreed(returns: list[Return], *, forget: bool) -> bool:
    for each in returns:
        if each.file.exists():
            print(f"{shown(each.file)} will be the starter again (yours is kept as {each.backup.name}).")
        else:
            print(f"{shown(each.file)} will be created.")
    if forget:
        print("Its progress will be deleted: best score, tries, hints.")
    if not sys.stdin.isatty():
        raise GradingError(
            "Nothing was changed: there is no terminal to ask you in. Add --yes to do it without asking."
        )
    try:
        return input("Go on? [y/N] ").strip().lower() in ("y", "yes")
    except EOFError:
        print()
        return False


def _carry_out(each: Return) -> None:
    try:
        saved = each.carry_out()
    except OSError as problem:
        raise GradingError(
            f"{each.file} could not be written: {problem.strerror or problem}. The file there is unchanged."
        ) from problem
    print(f"{shown(each.file)} is the starter" + (f" again; yours is kept as {saved.name}." if saved else "."))


def _forget(task: Exercise) -> int:
    trouble = progress.update(task.id, lambda _: None)
    if trouble:
        return cannot(trouble)
    print(f"The progress of {task.id} is deleted.")
    return 0


def solution(exercise_id: str, *, show: bool, copy: Path | None, folder: Path | None = None) -> int:
    """Print the solution, or copy it to a file that is not there yet; 1 when it has to be earned first.

    Args:
        exercise_id: which exercise.
        show: without a pass, for instructors. A lock would be no use: the solutions lie in the clone; what must stay
            secret is left out of the student edition.
        copy: the file to write, or the folder to write it into.
        folder: the folder of exercises, the course's own when None; solutions lie beside it.

    Raises:
        GradingError: there is none here, or it could not be written.
    """
    task = exercise.load(exercise_id, folder)
    source = task.solution
    if not source.is_file():
        raise GradingError("This edition of the course comes without solutions. Ask your instructor.")
    records, trouble = progress.read_or_tell()
    tell(trouble)
    known = records.get(task.id, progress.ProgressRecord())
    if not known.passed and not show:
        tell(_not_yet(task, known))
        return 1
    if copy is None:
        print(source.read_text(encoding="utf-8"), end="")
        return 0
    target = copy / source.name if copy.is_dir() else copy
    try:
        environment.files.write_new(target, source.read_bytes())
    except FileExistsError:
        raise GradingError(f"{target} already exists and is not overwritten. Name another file.") from None
    except OSError as problem:
        raise GradingError(f"{target} could not be written: {problem.strerror}.") from None
    print(f"The solution of {task.id} is in {shown(target)}.")
    return 0


def _not_yet(task: Exercise, known: progress.ProgressRecord) -> str:
    so_far = f"your best so far is {known.best:g}" if known.tries else "you have not been graded yet"
    return (
        f"you can see the solution once you have passed: {task.pass_mark:g} of {task.points:g} points; "
        f"{so_far}.\nStuck? {environment.command()} hint {task.id}\nInstructors: add --show."
    )

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
from course_kit.learner import learner_folder, progress, workspace
from course_kit.learner.workspace import shown
from course_kit.text.console import cannot, tell

if TYPE_CHECKING:
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

    def carry_out(self) -> None:
        """Save what is there, put the starter in its place, and say so; if that fails, the learner's file stays."""
        kept = f" again; yours is kept as {self.backup.name}" if self.file.exists() else ""
        try:
            if kept:
                saved = self.backup
                environment.files.write_new(saved, self.file.read_bytes())
                shutil.copystat(self.file, saved)
            environment.write_atomically(self.file, self.starter)
        except OSError as problem:
            raise GradingError(
                f"{self.file} could not be written: {problem.strerror or problem}. The file there is unchanged."
            ) from problem
        print(f"{shown(self.file)} is the starter{kept}.")


def changed(task: Exercise, place: Path | None = None) -> list[Return]:
    """The starter files of an exercise that the learner has changed, or that are not there."""
    found = []
    try:
        for name, file in _files(task, task.folder if place is None else place).items():
            starter = (task.folder / name).read_bytes()
            content = starter if file.parent == task.folder else learner_folder.as_handed_out(name, starter)
            if not file.exists() or file.read_bytes() not in (content, starter):
                found.append(Return(file, content))
    except OSError as problem:
        raise GradingError(f"{problem.filename} cannot be read: {problem.strerror}. Nothing was changed.") from None
    return found


def _files(task: Exercise, place: Path) -> dict[str, Path]:
    """Where each starter file belongs, by its name: both in a folder, or the one that a file's ending says."""
    if place.is_dir() or not place.suffix:
        return {name: place / name for name in (task.starter, task.notebook)}
    for name in (task.starter, task.notebook):
        if place.suffix == Path(name).suffix:
            return {name: place}
    raise GradingError(f"{place} is neither a .py nor an .ipynb file. Name your file, or the folder it is in.")


def reset(exercise_id: str, *, yes: bool, forget: bool, place: Path | None = None, folder: Path | None = None) -> int:
    """Put the starter back, after saving what is there, and ask before; 0 when done, 1 when the answer is no."""
    task = exercise.load(exercise_id, folder)
    if place is None:
        place = task.folder if folder is not None else workspace.exercise_folder(task)
    if place is None and not forget:
        raise workspace.no_files_of(task, "reset")
    returns = [] if place is None else changed(task, place)
    if not returns and not forget and place is not None:
        print(f"{task.id} already matches the starter: {shown(place)}")
        return 0
    nothing_to_lose = not forget and not any(each.file.exists() for each in returns)
    if not yes and not nothing_to_lose and not _agreed(returns, forget=forget):
        print("Nothing was changed.")
        return 1
    for each in returns:
        each.carry_out()
    if returns:
        print("If it is open in JupyterLab: File > Reload from Disk.")
    if forget:
        if trouble := progress.update(task.id, lambda _: None):
            return cannot(trouble)
        print(f"The progress of {task.id} is deleted.")
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


def solution(exercise_id: str, *, show: bool, copy: Path | None, folder: Path | None = None) -> int:
    """Print the solution, or copy it to a file that is not there yet; 1 when it has to be earned first."""
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

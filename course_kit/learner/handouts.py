"""`course-kit reset` and `solution`: what the course hands out beside a task. Files in `exercises/` are starters."""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading.errors import GradingError
from course_kit.grading.model.exercise import Exercise, load_exercise
from course_kit.learner import progress, workspace
from course_kit.learner.workspace import shorten_path
from course_kit.text.console import note, refuse

if TYPE_CHECKING:
    from course_kit.learner.progress import ProgressRecord


@dataclass(frozen=True)
class ChangedFile:
    """A learner's file that is no longer the starter, or is gone."""

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
        """Save the learner's file, put the starter in its place, and say so; if that fails, the file stays."""
        again = f" again; yours is kept as {self.backup.name}" if self.file.exists() else ""
        try:
            if again:
                saved = self.backup
                environment.files.write_new(saved, self.file.read_bytes())
                shutil.copystat(self.file, saved)
            environment.write_atomically(self.file, self.starter)
        except OSError as problem:
            raise GradingError(
                f"{self.file} could not be written: {problem.strerror or problem}. The file there is unchanged."
            ) from problem
        print(f"{shorten_path(self.file)} is the starter{again}.")


def changed_files(exercise: Exercise, place: Path | None = None) -> list[ChangedFile]:
    """The starter files of an exercise that the learner has changed, or that are not there."""
    found = []
    try:
        for name, file in _files(exercise, exercise.folder if place is None else place).items():
            starter = (exercise.folder / name).read_bytes()
            content = starter if file.parent == exercise.folder else workspace.clear_for_learner(name, starter)
            if not file.exists() or file.read_bytes() not in (content, starter):
                found.append(ChangedFile(file, content))
    except OSError as problem:
        raise GradingError(f"{problem.filename} cannot be read: {problem.strerror}. Nothing was changed.") from None
    return found


def _files(exercise: Exercise, place: Path) -> dict[str, Path]:
    """Where each starter file belongs, by its name: all in a folder, or the one that a file's name or ending says."""
    if place.is_dir() or not place.suffix:
        return {name: place / name for name in exercise.starters}
    for name in exercise.starters:
        if place.name == name or (place.suffix == Path(name).suffix and name not in exercise.files):
            return {name: place}
    raise GradingError(f"{place} is not one of the files of {exercise.id}: {', '.join(exercise.starters)}.")


def reset_exercise(exercise_id: str, *, forget: bool, place: Path | None = None) -> int:
    """Put the starter back, after saving the learner's file."""
    exercise = load_exercise(exercise_id)
    place = place or workspace.exercise_folder(exercise)
    if place is None and not forget:
        raise workspace.no_files_of(exercise, "reset")
    returns = [] if place is None else changed_files(exercise, place)
    if not returns and not forget and place is not None:
        print(f"{exercise.id} already matches the starter: {shorten_path(place)}")
        return 0
    for each in returns:
        each.carry_out()
    if returns:
        print("If it is open in JupyterLab: File > Reload from Disk.")
    if forget:
        if trouble := progress.update_progress(exercise.id, lambda _: None):
            return refuse(trouble)
        print(f"The progress of {exercise.id} is deleted.")
    return 0


def earned_solution(exercise_id: str) -> str:
    """The text of the solution."""
    text, sentence = _solution(load_exercise(exercise_id))
    if sentence:
        raise GradingError(sentence)
    return text


def show_solution(exercise_id: str, *, anyway: bool) -> int:
    """Print the solution; 1 when it has to be earned first."""
    text, sentence = _solution(load_exercise(exercise_id))
    if sentence and not anyway:
        note(sentence)
        return 1
    print(text, end="")
    return 0


def _solution(exercise: Exercise) -> tuple[str, str]:
    """The text, and why it is not to be seen yet."""
    if not exercise.solution.exists():
        raise GradingError("This edition of the course comes without solutions. Ask your instructor.")
    known = progress.read_progress()[0].get(exercise.id, progress.ProgressRecord())
    texts = [f"# --- {name}\n{(exercise.solution / name).read_text(encoding='utf-8')}" for name in exercise.files]
    text = "\n".join(texts) if texts else exercise.solution.read_text(encoding="utf-8")
    return text, "" if known.passed else _not_yet(exercise, known)


def _not_yet(exercise: Exercise, known: ProgressRecord) -> str:
    so_far = f"your best so far is {known.best:g}" if known.tries else "you have not been graded yet"
    return (
        f"You can see the solution once you have passed, with {exercise.pass_mark:g} of {exercise.points:g} points; "
        f"{so_far}.\nStuck? {environment.course_command()} hint {exercise.id}\nInstructors: add --show."
    )

"""`course-kit reset` and `solution`: what the course hands out beside a task. Files in `exercises/` are starters."""

from __future__ import annotations

import os
import shutil
from itertools import count
from pathlib import Path

from course_kit import environment
from course_kit.grading.errors import GradingError
from course_kit.grading.model.exercise import Exercise, load_exercise
from course_kit.learner import progress, workspace
from course_kit.learner.workspace import shorten_path
from course_kit.text.console import note, refuse


def put_starter(file: Path, starter: bytes) -> None:
    """Save a learner's file, put the starter in its place, and say so; if that fails, the file stays."""
    again = ""
    try:
        if file.exists():
            names = (file.with_name(f"{file.stem}.backup-{number}{file.suffix}") for number in count(1))
            backup = next(name for name in names if not os.path.lexists(name))  # the highest number is the newest
            environment.files.write_new(backup, file.read_bytes())
            shutil.copystat(file, backup)
            again = f" again; yours is kept as {backup.name}"
        environment.write_atomically(file, starter)
    except OSError as problem:
        raise GradingError(
            f"{file} could not be written: {problem.strerror or problem}. The file there is unchanged."
        ) from problem
    print(f"{shorten_path(file)} is the starter{again}.")


def changed_files(exercise: Exercise, place: Path) -> dict[Path, bytes]:
    """The files of an exercise that the learner has changed, or that are not there, with their starters."""
    found = {}
    try:
        for name, file in _files(exercise, place).items():
            starter = (exercise.folder / name).read_bytes()
            content = starter if file.parent == exercise.folder else workspace.clear_for_learner(name, starter)
            if not file.exists() or file.read_bytes() not in (content, starter):
                found[file] = content
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
    changed = {} if place is None else changed_files(exercise, place)
    if not changed and not forget and place is not None:
        print(f"{exercise.id} already matches the starter: {shorten_path(place)}")
        return 0
    for file, starter in changed.items():
        put_starter(file, starter)
    if changed:
        print("If it is open in JupyterLab: File > Reload from Disk.")
    if forget:
        if trouble := progress.update_progress(exercise.id, lambda _: None):
            return refuse(trouble)
        print(f"The progress of {exercise.id} is deleted.")
    return 0


def show_solution(exercise_id: str, *, anyway: bool) -> int:
    """Print the solution; 1 when it has to be earned first."""
    text, sentence = read_solution(exercise_id)
    if sentence and not anyway:
        note(sentence)
        return 1
    print(text, end="")
    return 0


def read_solution(exercise_id: str) -> tuple[str, str]:
    """The text of an exercise's solution, and why it is not to be seen yet."""
    exercise = load_exercise(exercise_id)
    if not exercise.solution.exists():
        raise GradingError("This edition of the course comes without solutions. Ask your instructor.")
    known = progress.read_progress()[0].get(exercise.id, progress.ProgressRecord())
    texts = [f"# --- {name}\n{(exercise.solution / name).read_text(encoding='utf-8')}" for name in exercise.files]
    text = "\n".join(texts) if texts else exercise.solution.read_text(encoding="utf-8")
    if known.passed:
        return text, ""
    so_far = f"your best so far is {known.best:g}" if known.tries else "you have not been graded yet"
    return text, (
        f"You can see the solution once you have passed, with {exercise.pass_mark:g} of {exercise.points:g} points; "
        f"{so_far}.\nStuck? {environment.course_command()} hint {exercise.id}\nInstructors: add --show."
    )

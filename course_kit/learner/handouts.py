"""`course-kit hint`, `reset` and `solution`: what the course hands out for an exercise beside its task.

A hint is one more rung of an exercise's ladder, for what failed last. Learners work in their own folder, so the
files in `exercises/` are the starters.
"""

from __future__ import annotations

import os
import shutil
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec import structs

from course_kit import environment
from course_kit.grading.errors import GradingError
from course_kit.grading.model.exercise import Exercise, load_exercise
from course_kit.learner import progress, workspace
from course_kit.learner.workspace import shorten_path
from course_kit.text.console import note, refuse, wrap_text

if TYPE_CHECKING:
    from course_kit.learner.progress import ProgressRecord

_wrap = partial(wrap_text, following="  ", whole_words=True)
_BEGINNING = "the beginning"  # the ladder of who has not been graded yet


@dataclass(frozen=True)
class HintLadder:
    """The hints for one thing."""

    key: str
    rungs: tuple[str, ...]
    about: str
    read_on: str = ""
    in_report: int = 0


def next_hint(exercise_id: str, command: str, *, again: bool = False, folder: Path | None = None) -> tuple[str, str]:
    """The next hint, and from then on the one after it; never the solution."""
    exercise = load_exercise(exercise_id, folder)
    records, trouble = progress.read_progress()
    known = records.get(exercise.id, progress.ProgressRecord())
    if known.tries and known.failed is None:
        return f"Nothing failed when {exercise.id} was last graded, so there are no hints to give.\n", trouble
    found = hint_ladder(exercise, known)
    given = min(known.hints.get(found.key, 0), len(found.rungs))
    if again:
        return _text(exercise, found, 0, max(given, found.in_report), command), trouble
    last = min(max(given, found.in_report) + 1, len(found.rungs))  # the report has shown the first
    if last > given:
        trouble = progress.update_progress(exercise.id, lambda old: _with_hints(old, found.key, last)) or trouble
    return _text(exercise, found, max(last - 1, 0), last, command), trouble


def _with_hints(known: ProgressRecord, key: str, count: int) -> ProgressRecord:
    return structs.replace(known, hints={**known.hints, key: max(count, known.hints.get(key, 0))})


def hint_ladder(exercise: Exercise, known: ProgressRecord) -> HintLadder:
    """The hints for what failed last: those of its cause, then those of its check. Without a failure, all there are."""
    failed = known.failed
    if failed is None:
        return HintLadder(_BEGINNING, tuple(entry.text for entry in exercise.hints), "from the beginning")
    cause = exercise.diagnosis(failed.diagnosis)
    of_cause = (exercise.ladder(cause.code) or (cause.hint,)) if cause else ()
    rungs = tuple(dict.fromkeys((*of_cause, *exercise.ladder(failed.check))))
    read_on = cause.link if cause and environment.paths.lesson_path(cause.notebook) else ""
    key = f"{failed.check} {failed.diagnosis or ''}".rstrip()
    return HintLadder(key, rungs, f"for '{failed.title}', which failed last", read_on, min(1, len(rungs)))


def _text(exercise: Exercise, found: HintLadder, first: int, last: int, command: str) -> str:
    count = len(found.rungs)
    lines = _wrap(f"{exercise.title} ({exercise.id}): hints {found.about}")
    for number in range(first + 1, last + 1):
        shown = ", as in the report" if number <= found.in_report else ""
        lines += ["", *_wrap(f"Hint {number} of {count}{shown}: {found.rungs[number - 1]}")]
    lines.append("")
    if not count:
        lines += _wrap("There are no hints for this one. Read the report again.")
    elif last < count:
        lines.append(f"Next hint: {command} {exercise.id}")
    else:
        lines += ["That was the last one. To see all of them again:", f"  {command} {exercise.id} --again"]
    if found.read_on and last >= count:
        lines += _wrap(f"Read on: {found.read_on}")
    if found.key == _BEGINNING:
        lines += _wrap("Once you have graded your file, the hints are about what fails in it.")
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class ChangedFile:
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
        print(f"{shorten_path(self.file)} is the starter{kept}.")


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
    """Where each starter file belongs, by its name: both in a folder, or the one that a file's ending says."""
    if place.is_dir() or not place.suffix:
        return {name: place / name for name in exercise.starters}
    for name in exercise.starters:
        if place.suffix == Path(name).suffix:
            return {name: place}
    raise GradingError(f"{place} is neither a .py nor an .ipynb file. Name your file, or the folder it is in.")


def reset_exercise(exercise_id: str, *, forget: bool, place: Path | None = None) -> int:
    """Put the starter back, after saving what is there."""
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
    text, said = _solution(load_exercise(exercise_id))
    if said:
        raise GradingError(f"{said[:1].upper()}{said[1:]}")
    return text


def show_solution(exercise_id: str, *, anyway: bool) -> int:
    """Print the solution; 1 when it has to be earned first."""
    text, said = _solution(load_exercise(exercise_id))
    if said and not anyway:
        note(said)
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
        f"you can see the solution once you have passed: {exercise.pass_mark:g} of {exercise.points:g} points; "
        f"{so_far}.\nStuck? {environment.course_command()} hint {exercise.id}\nInstructors: add --show."
    )

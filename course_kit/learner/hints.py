"""`course-kit hint`: one more rung of an exercise's ladder, for what failed last."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from msgspec import structs

from course_kit import environment
from course_kit.grading.model.exercise import Exercise, load_exercise
from course_kit.learner import progress
from course_kit.text.console import wrap_text

if TYPE_CHECKING:
    from pathlib import Path

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
        return _text(exercise, found, 0, given, command), trouble
    last = min(given + 1, len(found.rungs))  # a card folds the first as well

    def note_hint(old: ProgressRecord) -> ProgressRecord:
        return structs.replace(old, hints={**old.hints, found.key: max(last, old.hints.get(found.key, 0))})

    if last > given:
        trouble = progress.update_progress(exercise.id, note_hint) or trouble
    return _text(exercise, found, max(last - 1, 0), last, command), trouble


def hint_ladder(exercise: Exercise, known: ProgressRecord) -> HintLadder:
    """The hints for what failed last: those of its cause, then those of its check. Without a failure, all there are."""
    failed = known.failed
    if failed is None:
        return HintLadder(_BEGINNING, tuple(entry.text for entry in exercise.hints), "from the beginning")
    cause = exercise.diagnosis(failed.diagnosis)
    rungs = exercise.hints_for(failed.check, cause)
    read_on = cause.link if cause and environment.paths.lesson_path(cause.notebook) else ""
    key = f"{failed.check} {failed.diagnosis or ''}".rstrip()
    return HintLadder(key, rungs, f"for '{failed.title}', the first that failed", read_on)


def _text(exercise: Exercise, found: HintLadder, first: int, last: int, command: str) -> str:
    count = len(found.rungs)
    lines = _wrap(f"{exercise.title} ({exercise.id}): hints {found.about}")
    for number in range(first + 1, last + 1):
        lines += ["", *_wrap(f"Hint {number} of {count}: {found.rungs[number - 1]}")]
    lines.append("")
    if not count:
        lines += _wrap("There are no hints for this one. Read the report again.")
    elif last < count:
        lines.append(f"Next hint: {command} {exercise.id}")
    else:
        others = "" if found.key == _BEGINNING else " When it passes, the next that fails has its own."
        lines += [
            *_wrap(f"That was the last one.{others} To see all of them again:"),
            f"  {command} {exercise.id} --again",
        ]
    if found.read_on and last >= count:
        lines += _wrap(f"Read on: {found.read_on}")
    if found.key == _BEGINNING:
        lines += _wrap("Once you have graded your file, the hints are about what fails in it.")
    return "\n".join(lines) + "\n"

"""`course-kit hint` and `%hint`: one more rung of an exercise's ladder, for what failed last."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading import exercise
from course_kit.learner import progress
from course_kit.text.console import wrapped

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading.exercise import Exercise
    from course_kit.learner.progress import ProgressRecord

_wrap = partial(wrapped, following="  ", whole_words=True)
_BEGINNING = "the beginning"  # the ladder of who has not been graded yet


@dataclass(frozen=True)
class HintLadder:
    """The hints for one thing."""

    key: str
    rungs: tuple[str, ...]
    about: str
    read_on: str = ""
    in_report: int = 0


def hint(exercise_id: str, command: str, *, again: bool = False, folder: Path | None = None) -> tuple[str, str]:
    """The next hint, and from then on the one after it; never the solution."""
    task = exercise.load(exercise_id, folder)
    records, trouble = progress.read_or_tell()
    known = records.get(task.id, progress.ProgressRecord())
    if known.tries and known.failed is None:
        return f"Nothing failed when {task.id} was last graded, so there are no hints to give.\n", trouble
    found = ladder(task, known)
    given = min(known.hints.get(found.key, 0), len(found.rungs))
    if again:
        return _text(task, found, 0, max(given, found.in_report), command), trouble
    # The first call repeats what the report has shown, which may be long gone, and adds the rung after it.
    first, last = (given, given + 1) if given else (0, 1 + found.in_report)
    last = min(last, len(found.rungs))
    if last > given:
        trouble = progress.update(task.id, partial(_taken, key=found.key, count=last)) or trouble
    return _text(task, found, min(first, max(last - 1, 0)), last, command), trouble


def _taken(known: ProgressRecord, key: str, count: int) -> ProgressRecord:
    return replace(known, hints={**known.hints, key: max(count, known.hints.get(key, 0))})


def ladder(task: Exercise, known: ProgressRecord) -> HintLadder:
    """The hints for what failed last: those of its cause, then those of its check. Without a failure, all there are."""
    failed = known.failed
    if failed is None:
        return HintLadder(_BEGINNING, tuple(entry.text for entry in task.hints), "from the beginning")
    cause = task.diagnosis(failed.diagnosis)
    of_cause = (task.ladder(cause.code) or (cause.hint,)) if cause else ()
    rungs = tuple(dict.fromkeys((*of_cause, *task.ladder(failed.check))))
    read_on = cause.link if cause and environment.paths.lesson(cause.notebook) else ""
    key = f"{failed.check} {failed.diagnosis or ''}".rstrip()
    return HintLadder(key, rungs, f"for '{failed.title}', which failed last", read_on, min(1, len(rungs)))


def _text(task: Exercise, found: HintLadder, first: int, last: int, command: str) -> str:
    count = len(found.rungs)
    lines = _wrap(f"{task.title} ({task.id}): hints {found.about}")
    for number in range(first + 1, last + 1):
        shown = ", as in the report" if number <= found.in_report else ""
        lines += ["", *_wrap(f"Hint {number} of {count}{shown}: {found.rungs[number - 1]}")]
    lines.append("")
    if not count:
        lines += _wrap("There are no hints for this one. Read what the report says about it again.")
    elif last < count:
        lines.append(f"Next hint: {command} {task.id}")
    else:
        lines += ["That was the last one. To see all of them again:", f"  {command} {task.id} --again"]
    if found.read_on and last >= count:
        lines += _wrap(f"Read on: {found.read_on}")
    if found.key == _BEGINNING:
        lines += _wrap("Once you have graded your file, the hints are about what fails in it.")
    return "\n".join(lines) + "\n"

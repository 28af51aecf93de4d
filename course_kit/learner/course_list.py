"""`course-kit list`: the exercises in the course's order, and what was reached in each."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, TypeGuard

from course_kit import environment
from course_kit.grading import exercise, exercise_folders
from course_kit.grading.errors import GradingError
from course_kit.learner import progress, workspace
from course_kit.quiz import guesses
from course_kit.text.console import wrapped

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading.exercise import Exercise
    from course_kit.learner.progress import ProgressRecord

FORMAT_VERSION = 1
_KINDS = {guesses.GUESS: "guesses", guesses.CHECK: "checks"}


@dataclass(frozen=True)
class Row:
    """One exercise with its record."""

    task: Exercise
    known: ProgressRecord

    @property
    def state(self) -> str:
        """In words, for those who see no tick."""
        if self.known.passed:
            return "passed"
        return "not passed yet" if self.known.tries else "not tried yet"

    def to_mapping(self) -> dict[str, object]:
        """The row as JSON shows it."""
        return {
            "id": self.task.id,
            "title": self.task.title,
            "points": self.task.points,
            "pass_mark": self.task.pass_mark,
            "passed": self.known.passed,
            "best_score": self.known.best if self.known.tries else None,
            "tries": self.known.tries,
            "hints": sum(self.known.hints.values()),
            "first_passed": self.known.first_passed or None,
            "last_try": self.known.last_try or None,
        }


def rows(folder: Path | None = None, *, practice: bool = False) -> tuple[list[Row], list[str]]:
    """All exercises in their order, and what to tell the user about files that cannot be used."""
    records, trouble = progress.read_or_tell()
    found_folders = exercise.find(folder)
    names = {*found_folders.folders, *(exercise_folders.drills(folder) if practice else ())}
    loaded = [_load(name, folder) for name in sorted(names)]
    found = [Row(task, records.get(task.id, progress.ProgressRecord())) for task in loaded if _is(task, practice)]
    told = [trouble, *(problem for problem in loaded if isinstance(problem, str)), *found_folders.problems]
    return sorted(found, key=lambda row: (row.task.order, row.task.id)), [sentence for sentence in told if sentence]


def _is(task: Exercise | str, practice: bool) -> TypeGuard[Exercise]:
    """Whether it was loaded, and is what is listed: an exercise, or a drill."""
    return not isinstance(task, str) and task.practice == practice


def _load(name: str, folder: Path | None) -> Exercise | str:
    """The exercise, or what is wrong with it: one that is being written must not hide the others."""
    try:
        return exercise.load(name, folder)
    except GradingError as problem:
        return str(problem)


def to_json(found: list[Row]) -> str:
    """One JSON document."""
    questions = [asdict(score) for score in guesses.scores()]
    exercises = [row.to_mapping() for row in found]
    content = {"format_version": FORMAT_VERSION, "exercises": exercises, "questions": questions}
    return json.dumps(content, indent=2, ensure_ascii=False)


def to_text(found: list[Row], encoding: str | None) -> str:
    """A table of at most 80 columns, with a tick where the terminal has one."""
    width = max((len(row.task.id) for row in found), default=0)
    lines = [f"       {'exercise':<{width}}  points  to pass  best  tries"]
    for row in found:
        lines += _lines(row, width, tick(encoding))
    passed = sum(row.known.passed for row in found)
    lines += ["", f"{passed} of {len(found)} passed."]
    following = next((row.task for row in found if not row.known.passed), None)
    if following is not None:
        folder = workspace.exercise_folder(following)
        where = f"after: {environment.command()} copy" if folder is None else f"in {workspace.shown(folder)}"
        lines.append(f"Next: {following.id}, {where}")
    return "\n".join([*lines, *_guessed()])


def _guessed() -> list[str]:
    """A line for each lesson of which any question was answered: what was right at the first try."""
    by_lesson: dict[str, list[str]] = {}
    for score in guesses.scores():
        if "/" not in score.lesson:  # a demo is a lecturer's
            open_ones = f" ({score.answered} answered)" if score.answered < score.count else ""
            said = f"{_KINDS[score.kind]} right: {score.right} of {score.count}{open_ones}"
            by_lesson.setdefault(score.lesson, []).append(said)
    lines = [f"  {lesson}: {'; '.join(said)}" for lesson, said in by_lesson.items()]
    return ["", "At the first try, in the lessons:", *lines] if lines else []


def _lines(row: Row, width: int, tick: str) -> list[str]:
    task, known = row.task, row.known
    best = f"{known.best:g}" if known.tries else "-"
    mark = tick if known.passed else " "
    head = f"[{mark}] {task.order:>2} {task.id:<{width}}  {task.points:>6g}  {task.pass_mark:>7g}  {best:>4}  "
    title = wrapped(task.title, " " * 7, " " * 7)
    where = [f"       {workspace.shown(task.folder / task.notebook)}"] if exercise_folders.is_added(task.folder) else []
    return [f"{head}{known.tries:>5}  {row.state}", *title, *where]


def tick(encoding: str | None) -> str:
    """The mark for what is done, as far as a terminal can show it."""
    try:
        "✓".encode(encoding or "ascii")
    except (UnicodeEncodeError, LookupError):
        return "x"
    return "✓"

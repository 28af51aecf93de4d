"""`course-kit list` and `drills`: what there is in the course's order, what was reached in each, and what is next.

Drills are small repairs for practice, without points.
"""

from __future__ import annotations

import json
import re
import shlex
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING
from urllib.parse import quote

from course_kit import environment
from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import Exercise, list_exercise_ids, load_exercise
from course_kit.learner import handouts, progress, workspace
from course_kit.quiz import guesses
from course_kit.ros.names import did_you_mean
from course_kit.text.console import wrap_text

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.learner.progress import ProgressRecord

FORMAT_VERSION = 1
_INDENT = " " * 4


@dataclass(frozen=True)
class Row:
    """One exercise with its record."""

    exercise: Exercise
    known: ProgressRecord

    def to_mapping(self) -> dict[str, object]:
        """The row as JSON shows it."""
        return {
            "id": self.exercise.id,
            "title": self.exercise.title,
            "points": self.exercise.points,
            "pass_mark": self.exercise.pass_mark,
            "passed": self.known.passed,
            "best_score": self.known.best if self.known.tries else None,
            "tries": self.known.tries,
            "hints": sum(self.known.hints.values()),
            "first_passed": self.known.first_passed or None,
            "last_try": self.known.last_try or None,
        }


def list_rows(folder: Path | None = None, *, practice: bool = False) -> tuple[list[Row], list[str]]:
    """All exercises in their order, and what to tell the user about files that cannot be used."""
    records, trouble = progress.read_progress()
    there = exercise_folders.find_exercises(folder)
    found, problems = [], [trouble]
    for name in sorted({*there.folders, *(there.drills if practice else ())}):
        try:
            exercise = load_exercise(name, folder)
        except GradingError as problem:  # noqa: PERF203 - one that is being written must not hide the others
            problems.append(str(problem))
        else:
            found.append(Row(exercise, records.get(exercise.id, progress.ProgressRecord())))
    found = sorted((row for row in found if row.exercise.practice == practice), key=lambda row: row.exercise.order)
    return found, [sentence for sentence in (*problems, *there.problems) if sentence]


def format_json(found: list[Row]) -> str:
    """One JSON document."""
    questions = [asdict(score) for score in guesses.lesson_scores()]
    exercises = [row.to_mapping() for row in found]
    content = {"format_version": FORMAT_VERSION, "exercises": exercises, "questions": questions}
    return json.dumps(content, indent=2, ensure_ascii=False)


def format_list(found: list[Row]) -> str:
    """A table of at most 80 columns."""
    width = max((len(row.exercise.id) for row in found), default=0)
    lines = [f"       {'exercise':<{width}}  points  to pass  best  tries"]
    for row in found:
        lines += _lines(row, width)
    passed = sum(row.known.passed for row in found)
    lines += ["", f"{passed} of {len(found)} passed."]
    if following := next((row.exercise for row in found if not row.known.passed), None):
        folder = workspace.exercise_folder(following)
        where = (
            f"after: {environment.course_command()} copy" if folder is None else f"in {workspace.shorten_path(folder)}"
        )
        lines.append(f"Next exercise: {following.id}, {where}")
    lessons = _lessons()
    steps = [f"  {lesson.name}: {lesson.done} of {lesson.steps}" for lesson in lessons if lesson.steps]
    tried = any(lesson.tried for lesson in lessons)
    return "\n".join([*lines, *(["", "Steps of the lessons:", *steps] if tried else [])])


@dataclass(frozen=True)
class LessonProgress:
    """A lesson with how many of its steps are done, and tried."""

    name: str
    steps: int
    done: int
    tried: int

    @property
    def title(self) -> str:
        """Its number and its subject, "1. Services"."""
        number, _, words = self.name.partition("_")
        return f"{int(number)}. {words.replace('_', ' ').capitalize()}"


def _lessons() -> list[LessonProgress]:
    (records, _), root, found = progress.read_progress(), environment.course_files(), []
    for path in sorted((root / "notebooks").glob("0*.ipynb")) if root is not None else []:
        names = re.findall(r'"%check (\w+)"', path.read_text(encoding="utf-8"))  # importing the steps takes a second
        known = [records[key] for name in names if (key := f"{path.stem}/{name}") in records]
        found.append(LessonProgress(path.stem, len(names), sum(step.passed for step in known), len(known)))
    return found


def _last_heading(notebook: Path) -> str:
    """The heading above the last of the cells that have run; "" where none has."""
    heading = reached = ""
    with suppress(OSError, ValueError, LookupError, TypeError):
        for cell in json.loads(notebook.read_bytes())["cells"]:
            text = re.sub("```.*?```", "", "".join(cell["source"]), flags=re.DOTALL)
            if cell["cell_type"] == "markdown":
                heading = [heading, *re.findall(r"^#+ (.+)$", text, re.MULTILINE)][-1]
            elif cell.get("execution_count"):
                reached = heading
    return re.sub("[`*_]", "", reached).strip()


def format_progress_page(folder: Path, last: str) -> str:
    """The page that a learner sees first on their second day; "" before anything is done."""
    lessons, (exercises, _), (drills, _) = _lessons(), list_rows(), list_rows(practice=True)
    if not any(lesson.tried for lesson in lessons) and not any(row.known.tries for row in (*exercises, *drills)):
        return ""
    scores = {(score.lesson, score.kind): f"{score.right} of {score.count}" for score in guesses.lesson_scores()}
    heading = _last_heading(folder / last)
    lines = ["# Where you are", "", f"Go on with [{last}]({last})."]
    if heading:
        place = quote(heading.replace(" ", "-"))
        lines += [f"The furthest of its cells that ran is under [{heading}]({last}#{place})."]
    if following := next((lesson for lesson in lessons if lesson.done < lesson.steps), None):
        lines += [f"The first lesson with open steps is [{following.title}](notebooks/{following.name}.ipynb)."]
    lines += ["The page is as old as this start of JupyterLab; later steps and tries: `./course list` in the terminal."]
    lines += ["", "| lesson | steps done | guesses right at once | questions right at once |", "|---|---|---|---|"]
    for lesson in lessons:
        steps = f"{lesson.done} of {lesson.steps}" if lesson.steps else ""
        asked = " | ".join(scores.get((lesson.name, kind), "") for kind in (guesses.GUESS, guesses.CHECK))
        lines.append(f"| [{lesson.title}](notebooks/{lesson.name}.ipynb) | {steps} | {asked} |")
    for title, found in (("exercise", exercises), ("drill", drills)):
        lines += ["", f"| {title} | best | tries | |", "|---|---|---|---|"]
        for row in found:
            known, path = row.known, exercise_folders.in_course(row.exercise.folder, row.exercise.notebook)
            state = "done" if known.passed else "open" if known.tries else ""
            best = f"{known.best:g} of {row.exercise.points:g}" if known.tries else ""
            lines.append(f"| [{row.exercise.title}]({path}) | {best} | {known.tries or ''} | {state} |")
    return "\n".join([*lines, ""])


def _lines(row: Row, width: int) -> list[str]:
    exercise, known = row.exercise, row.known
    best = f"{known.best:g}" if known.tries else "-"
    mark = "x" if known.passed else " "
    state = "passed" if known.passed else "not passed yet" if known.tries else "not tried yet"
    numbers = f"{exercise.points:>6g}  {exercise.pass_mark:>7g}  {best:>4}  {known.tries:>5}"
    lines = [f"[{mark}] {exercise.order:>2} {exercise.id:<{width}}  {numbers}  {state}"]
    lines += wrap_text(exercise.title, " " * 7, " " * 7)
    if exercise_folders.is_added(exercise.folder):
        lines.append(f"       {workspace.shorten_path(exercise.folder / exercise.notebook)}")
    return lines


def next_step(passed: str, root: Path | None = None, *, in_notebook: bool = False) -> str:
    """What to do after an exercise was passed: lessons and the next exercise; after a drill the next drill."""
    exercise, command = load_exercise(passed), environment.course_command()
    rows, _ = list_rows(practice=exercise.practice)
    if exercise.practice:
        left = next((row.exercise.id for row in rows if not row.known.passed and row.exercise.id != passed), None)
        way = f"Next: {command} drills {left}." if left else "That was the last drill."
    elif following := next((row.exercise for row in rows if row.exercise.order > exercise.order), None):
        lessons, root = "", root or environment.course_files()
        for path in sorted((root / "notebooks").glob("0*.ipynb"))[exercise.order + 1 :] if root is not None else []:
            lessons += f"lesson {int(path.name[:2])}, notebooks/{path.name}; "
            if f"/{following.notebook})" in path.read_text(encoding="utf-8"):  # its last lines lead to the exercise
                break
        way = f"Next: {lessons}{'then ' * bool(lessons)}exercise {following.order}, {following.id}."
    else:
        way = "That was the last exercise."
    if not exercise.solution.exists():  # a student edition has none
        return way
    if in_notebook:
        return f"{way} Compare yours with ours: %solution {exercise.id}"
    where = f" --exercises {shlex.quote(str(exercise.folder))}" if exercise_folders.is_added(exercise.folder) else ""
    return f"{way} Compare yours with ours: {command} solution {exercise.id}{where}"


def describe_drills() -> tuple[str, list[str]]:
    """All drills with their symptoms, a cross for each that is done, and what to tell the user about unusable files."""
    found, problems = list_rows(practice=True)
    lines = ["Small repairs, five to ten minutes each: practice without points.", ""]
    for row in found:
        mark, done = ("x", ": done") if row.known.passed else (" ", "")
        lines.append(f"[{mark}] {row.exercise.order} {row.exercise.id}{done}")
        lines += wrap_text(row.exercise.symptom, _INDENT, _INDENT)
    lines += ["", f"{sum(row.known.passed for row in found)} of {len(found)} done."]
    if following := next((row.exercise.id for row in found if not row.known.passed), None):
        lines.append(f"Next: {environment.course_command()} drills {following}")
    return "\n".join(lines), problems


def begin_drill(drill_id: str) -> str:
    """What a drill is about, and how to work on it; its program is put where it belongs if it is not there."""
    drills = {row.exercise.id: row.exercise for row in list_rows(practice=True)[0]}
    if drill_id not in drills:
        if drill_id in list_exercise_ids():
            raise GradingError(f"{drill_id} is an exercise, not a drill. See {environment.course_command()} list.")
        guess = did_you_mean(drill_id, drills)
        raise GradingError(f"There is no drill '{drill_id}'.{guess} Drills: {', '.join(drills) or 'none'}.")
    exercise = drills[drill_id]
    place = workspace.exercise_folder(exercise)
    if place is None:
        raise workspace.no_files_of(exercise, "watch")
    for file, starter in handouts.changed_files(exercise, place).items():
        if not file.exists():
            handouts.put_starter(file, starter)
    command, program = environment.course_command(), workspace.shorten_path(place / exercise.starter)
    lines = [*wrap_text(f"Drill {exercise.order}: {exercise.title}", "", _INDENT), "", *wrap_text(exercise.symptom), ""]
    lines += [
        f"The program:     {program}",
        f"In a notebook:   {workspace.shorten_path(place / exercise.notebook)}",
        f"While you work:  {command} watch {exercise.id}",
        f"Is it done?      {command} grade {exercise.id} {program}",
        f"A hint:          {command} hint {exercise.id}",
        f"Start again:     {command} reset {exercise.id}",
    ]
    return "\n".join(lines)

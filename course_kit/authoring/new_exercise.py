"""`course-kit new exercise`: the folder of an exercise that works at once, to be changed into another one.

The texts that learners read are written once: the sentences of the task in exercise.toml, the program to begin with in
the starter. The starter's docstring and the notebook are made from them, and made anew by `refresh`.
"""

from __future__ import annotations

import keyword
import os
import re
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.authoring import exercise_notebook, task_text
from course_kit.environment import write_atomically
from course_kit.grading import exercise, exercise_folders
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.grading.exercise import Exercise

KINDS = ("service", "action", "parameters", "topic")
_TEMPLATES = Path(__file__).with_name("templates") / "new_exercise"
_ENDING = ".in"  # keeps linters and pytest from taking a template for something to run
_NAME = re.compile(r"[a-z][a-z0-9_]*\Z")
_LONGEST = 40
_IN_PLACE_OF_NAME, _IN_PLACE_OF_CLASS = "@ID@", "@CLASS@"


def create(name: str, kind: str, folder: Path) -> Exercise:
    """Make a new exercise.

    It appears under its name only when it is complete.
    """
    _require_usable(name)
    target = folder.absolute() / name
    if os.path.lexists(target):
        raise GradingError(f"{target} exists already. Choose another name, or another folder with --in.")
    if places := exercise_folders.find().folders.get(name):
        raise GradingError(f"There is an exercise '{name}' already, in {places[0]}. Choose another name.")
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".new-", dir=folder) as workshop:
        made = Path(workshop) / name
        for path, text in _files(name, kind):
            (made / path).parent.mkdir(parents=True, exist_ok=True)
            (made / path).write_text(text, encoding="utf-8")
        task = exercise.read(made)
        (made / task.notebook).write_text(exercise_notebook.new(task), encoding="utf-8")
        refresh(task)
        made.rename(target)
    return exercise.read(target)


def refresh(task: Exercise) -> list[Path]:
    """Write the sentences of an exercise anew into its starter and its notebook, and the starter into the notebook."""
    if not exercise_folders.is_added(task.folder):
        raise GradingError(
            f"{task.id} belongs to the course. Write its task anew with: python -m course_kit.authoring.task_text "
            f"{task.id}, and its notebook by hand."
        )
    program, notebook = task.folder / task.starter, task.folder / task.notebook
    before = {path: path.read_text(encoding="utf-8") for path in (program, notebook)}
    starter = _titled(task_text.in_starter(before[program], task), task)
    with_starter = exercise_notebook.renewed(before[notebook], task, starter)
    after = {program: starter, notebook: task_text.in_notebook(with_starter, task)}
    changed = [path for path in after if after[path] != before[path]]
    for path in changed:
        write_atomically(path, after[path])
    return changed


def _titled(starter: str, task: Exercise) -> str:
    """A starter whose docstring begins with the exercise's title."""
    return re.sub(r'\A\s*"""[^\n]*', lambda _: f'"""{task.title}.', starter)


def _require_usable(name: str) -> None:
    if _NAME.match(name) and len(name) <= _LONGEST and not keyword.iskeyword(name):
        return
    other = re.sub(r"[^a-z0-9]+", "_", re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()).strip("_")
    proposal = f", such as {other}" if _NAME.match(other) and not keyword.iskeyword(other) else ""
    raise GradingError(
        f"'{name}' cannot be the name of an exercise. Write up to {_LONGEST} small letters, digits and _, a letter "
        f"first{proposal[:_LONGEST]}."
    )


def _files(name: str, kind: str) -> Iterator[tuple[Path, str]]:
    """The files of a new exercise and what they hold, but for its notebook."""
    folder = _TEMPLATES / kind
    names = {"starter.py": f"{name}.py", "solution.py": f"solution/{name}.py"}
    class_name = "".join(part.capitalize() for part in name.split("_"))
    for path in sorted(folder.rglob(f"*{_ENDING}")):
        inside = path.relative_to(folder).as_posix().removesuffix(_ENDING)
        text = path.read_text(encoding="utf-8")
        filled_in = text.replace(_IN_PLACE_OF_NAME, name).replace(_IN_PLACE_OF_CLASS, class_name)
        yield Path(names.get(inside, inside)), filled_in

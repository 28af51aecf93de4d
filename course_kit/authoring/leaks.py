"""Looks for answers in a student edition: programs that score more than a starter, and those with a solution's shape.

Programs are files: modules, tests and notebooks. What is hidden in texts, outputs, pictures or archives is not found.
"""

from __future__ import annotations

import json
import re
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.authoring.gradings import Gradings
from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise
from course_kit.reader import fingerprints

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from course_kit.grading.model.exercise import Exercise

_SEED = 1
_FEW = 6  # programs: no more workers are started for them
_ALIKE = 0.5  # of a solution's fingerprints that its starter has not; of other programs the most alike has 0.13
_FEWEST = 30  # such fingerprints: a smaller repair has no shape that others have not


@dataclass(frozen=True)
class Leak:
    """A program that a student edition must not hold: its file, relative to the edition, and why."""

    file: str
    exercise: str
    why: str


def find(edition: Path, solutions: Mapping[str, Path]) -> list[Leak]:
    """Look for answers in an edition."""
    tasks = [exercise.load(name, edition / "exercises") for name in solutions]
    texts = {path: _read_code(path) for path in sorted(edition.rglob("*")) if path.suffix in (".py", ".ipynb", ".md")}
    found = [*_find_alike(tasks, solutions, texts), *_find_scoring(tasks, texts)]
    return [Leak(path.relative_to(edition).as_posix(), task.id, why) for path, task, why in found]


def _read_code(path: Path) -> str:
    """A program, the cells of a notebook, or the text of a page."""
    text = path.read_text(encoding="utf-8", errors="replace")
    if path.suffix == ".ipynb":
        with suppress(ValueError, KeyError, TypeError):
            return "\n".join("".join(cell["source"]) for cell in json.loads(text)["cells"])
    return text


def _find_alike(
    tasks: list[Exercise], solutions: Mapping[str, Path], texts: Mapping[Path, str]
) -> Iterator[tuple[Path, Exercise, str]]:
    prints = {path: fingerprints.fingerprints(text) for path, text in texts.items()}
    for task in tasks:
        if solutions[task.id].is_file():
            solution = fingerprints.fingerprints(solutions[task.id].read_text(encoding="utf-8"))
            own = solution - prints[task.folder / task.starter]
            for path, found in prints.items():
                share = len(own & found) / max(len(own), _FEWEST)
                if share > _ALIKE:
                    yield path, task, f"has {share:.0%} of the solution's own lines"


def _find_scoring(tasks: list[Exercise], texts: Mapping[Path, str]) -> Iterator[tuple[Path, Exercise, str]]:
    scores = _grade(tasks, texts)
    for task in tasks:
        of_task = {path: score for (path, name), score in scores.items() if name == task.id}
        starters = [of_task.pop(task.folder / name, None) for name in (task.starter, task.notebook)]
        if None in starters:
            raise GradingError(f"A starter of {task.id} cannot be graded. See course-kit dev check {task.id}.")
        allowed = max(score for score in starters if score is not None)
        if allowed >= task.pass_mark:
            yield task.folder / task.starter, task, f"the starter scores {allowed:g} of {task.points:g}"
        for path, score in of_task.items():
            if score > allowed:
                yield path, task, f"scores {score:g} of {task.points:g}, the starter {allowed:g}"


def _grade(tasks: list[Exercise], texts: Mapping[Path, str]) -> dict[tuple[Path, str], float]:
    """The score of each program that could be for an exercise, by its file and the exercise."""
    ready = []
    for task in tasks:
        clue = rf"^class {task.class_name}\b" if task.class_name else rf"^{task.variable}\b"
        named = (path for path, text in texts.items() if re.search(clue, text, re.MULTILINE))
        ready += [(path, task.id) for path in named if path.suffix != ".md"]
    with Gradings(tasks, len(ready) if len(ready) < _FEW else 0) as pool:
        waiting = {(path, name): pool.begin_file(name, path, _SEED) for path, name in ready}
        reports = {key: future.result() for key, future in waiting.items()}
    for (path, name), report in reports.items():
        if report.status == "error":
            raise GradingError(f"{path.name} could not be graded as {name}: {report.problem} Run this again.")
    return {key: report.score for key, report in reports.items() if report.status != "unreadable"}

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
from course_kit.grading.model.exercise import Exercise, load_exercise
from course_kit.reader import fingerprints
from course_kit.reader.text import PROGRAM

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path


_SEED = 1
_ALIKE = 0.5  # of a solution's fingerprints that its starter has not; of other programs the most alike has 0.13
_FEWEST = 30  # such fingerprints: a smaller repair has no shape that others have not


@dataclass(frozen=True)
class Leak:
    """A program that a student edition must not hold: its file, relative to the edition, and why."""

    file: str
    exercise: str
    why: str


def find_leaks(edition: Path, solutions: Mapping[str, Path]) -> list[Leak]:
    """Look for answers in an edition."""
    exercises = [load_exercise(name, edition / "exercises") for name in solutions]
    texts = {path: _read_code(path) for path in sorted(edition.rglob("*")) if path.suffix in (".py", ".ipynb", ".md")}
    found = [*_find_alike(exercises, solutions, texts), *_find_scoring(exercises, texts)]
    return [Leak(path.relative_to(edition).as_posix(), exercise.id, why) for path, exercise, why in found]


def _read_code(path: Path) -> str:
    """A program, the cells of a notebook, or the text of a page."""
    text = path.read_text(encoding="utf-8", errors="replace")
    if path.suffix == ".ipynb":
        with suppress(ValueError, KeyError, TypeError):
            return "\n".join("".join(cell["source"]) for cell in json.loads(text)["cells"])
    return text


def _find_alike(
    exercises: list[Exercise], solutions: Mapping[str, Path], texts: Mapping[Path, str]
) -> Iterator[tuple[Path, Exercise, str]]:
    prints = {path: fingerprints.take_fingerprints(text) for path, text in texts.items()}
    for exercise in exercises:
        solution = solutions[exercise.id]
        programs = [name for name in exercise.files or (exercise.starter,) if name.endswith(PROGRAM)]
        for name in programs if solution.exists() else ():
            text = (solution / name if solution.is_dir() else solution).read_text(encoding="utf-8")
            own = fingerprints.take_fingerprints(text) - prints[exercise.folder / name]
            for path, found in prints.items():
                share = len(own & found) / max(len(own), _FEWEST)
                if share > _ALIKE:
                    yield path, exercise, f"has {share:.0%} of the solution's own lines"


def _find_scoring(exercises: list[Exercise], texts: Mapping[Path, str]) -> Iterator[tuple[Path, Exercise, str]]:
    scores = _grade(exercises, texts)
    for exercise in exercises:
        of_exercise = {path: score for (path, name), score in scores.items() if name == exercise.id}
        program = "" if exercise.files else exercise.starter  # of several files the folder
        starters = [of_exercise.pop(exercise.folder / name, None) for name in (program, exercise.notebook)]
        if None in starters:
            raise GradingError(f"A starter of {exercise.id} cannot be graded. See course-kit dev check {exercise.id}.")
        allowed = max(score for score in starters if score is not None)
        if allowed >= exercise.pass_mark:
            yield exercise.folder / exercise.starter, exercise, f"the starter scores {allowed:g} of {exercise.points:g}"
        for path, score in of_exercise.items():
            if score > allowed:
                yield path, exercise, f"scores {score:g} of {exercise.points:g}, the starter {allowed:g}"


def _grade(exercises: list[Exercise], texts: Mapping[Path, str]) -> dict[tuple[Path, str], float]:
    """The score of each program that could be for an exercise, by its file and the exercise."""
    ready: list[tuple[Path, str]] = []
    for exercise in exercises:
        clue = rf"^class {exercise.class_name}\b" if exercise.class_name else rf"^{exercise.variable}\b"
        if exercise.files:
            clue = rf"^%%submission {exercise.id}\b"
            ready += {(path.parent, exercise.id) for path in texts if path.name in exercise.files}
        named = (path for path, text in texts.items() if re.search(clue, text, re.MULTILINE))
        ready += [(path, exercise.id) for path in named if path.suffix != ".md"]
    with Gradings(exercises) as pool:
        requests = (((path, name), pool.request_for_program(name, path, _SEED)) for path, name in ready)
        reports = dict(pool.grade_all(requests))
    for (path, name), report in reports.items():
        if report.status == "error":
            raise GradingError(f"{path.name} could not be graded as {name}: {report.problem} Run this again.")
    return {key: report.score for key, report in reports.items() if report.status != "unreadable"}

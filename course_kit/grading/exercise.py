"""An exercise's folder: what stands in its exercise.toml, checked when it is read."""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading import sentences
from course_kit.grading.diagnosis import catalogue
from course_kit.grading.errors import GradingError
from course_kit.grading.limits import Limits
from course_kit.ros.names import did_you_mean

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from course_kit.grading.diagnosis.catalogue import Diagnosis
    from course_kit.grading.plain_data import Record
    from course_kit.grading.sentences import Sentence

FORMAT_VERSION = 1
_IDENTIFIER = re.compile(r"[a-z][a-z0-9_]*\Z")
_TEXTS = ("id", "title", "starter", "notebook", "grader")


@dataclass(frozen=True)
class Hint:
    """One rung of the ladder, and what it helps with: ids of checks (`*_reason` means all that end so), diagnoses."""

    topics: tuple[str, ...]
    text: str


@dataclass(frozen=True)
class Exercise:
    """One exercise.

    Attributes:
        folder: where it lies.
        id: its name, which is the folder's.
        title: for people.
        order: its place in the course.
        points: full marks.
        pass_mark: the points from which it is passed.
        starter: the file name of the starter program.
        notebook: the file name of its notebook.
        grader: the module with its checks.
        class_name: the Node class a submission defines.
        variable: what a submission sets instead, in exercises without ROS.
        seed: what the checks draw from when nobody gives a seed; drawn itself when None.
        limits: what a submission may use.
        hints: the ladder, from a nudge to a push.
        diagnoses: by code, those that it words in its own way or links elsewhere.
        sentences: its task, sentence by sentence.
    """

    folder: Path
    id: str
    title: str
    order: int
    points: float
    pass_mark: float
    starter: str
    notebook: str
    grader: str
    class_name: str
    variable: str
    seed: int | None
    limits: Limits
    hints: tuple[Hint, ...]
    diagnoses: Mapping[str, Diagnosis]
    sentences: tuple[Sentence, ...] = ()

    def ladder(self, topic: str) -> tuple[str, ...]:
        """The hints for a check or a diagnosis, from a nudge to a push; empty when there are none."""
        return tuple(hint.text for hint in self.hints if any(fnmatchcase(topic, name) for name in hint.topics))

    def diagnosis(self, code: str | None) -> Diagnosis | None:
        """A diagnosis as this exercise words it, else as the catalogue does; None when there is none of this code."""
        return self.diagnoses.get(code or "") or catalogue.catalogue().get(code or "")


def exercises_folder() -> Path:
    """The course's folder of exercises.

    Raises:
        GradingError: this installation has none.
    """
    root = environment.checkout()
    if root is None or not (root / "exercises").is_dir():
        raise GradingError("There is no exercises folder here. Run this from a clone of the course.")
    return root / "exercises"


def ids(folder: Path | None = None) -> list[str]:
    """The ids of all exercises, in the alphabet's order.

    Raises:
        GradingError: this installation has none.
    """
    folder = exercises_folder() if folder is None else folder
    return sorted(path.parent.name for path in folder.glob("*/exercise.toml"))


def load(exercise_id: str, folder: Path | None = None) -> Exercise:
    """Read one exercise.

    Args:
        exercise_id: its id.
        folder: the folder of exercises, the course's own when None.

    Raises:
        GradingError: there is none of this id, or its exercise.toml has a mistake.
    """
    folder = exercises_folder() if folder is None else folder
    known = ids(folder)
    if exercise_id not in known:
        guess = did_you_mean(exercise_id, known)
        raise GradingError(f"There is no exercise '{exercise_id}'.{guess} There are: {', '.join(known) or 'none'}.")
    path = folder / exercise_id / "exercise.toml"
    try:
        return _parse(tomllib.loads(path.read_text(encoding="utf-8")), path.parent)
    except (OSError, ValueError, KeyError, TypeError) as problem:
        what = f"'{problem.args[0]}' is missing" if isinstance(problem, KeyError) else problem
        raise GradingError(f"{path} cannot be used: {what}.") from problem


def _parse(table: Record, folder: Path) -> Exercise:
    if table["format_version"] != FORMAT_VERSION:
        raise ValueError(f"its format_version is {table['format_version']}, but this kit reads {FORMAT_VERSION}")
    for name in _TEXTS:
        if not isinstance(table[name], str) or not table[name]:
            raise ValueError(f"'{name}' is not a text")
    if table["id"] != folder.name or not _IDENTIFIER.match(table["id"]):
        raise ValueError(f"its id '{table['id']}' is not the name of its folder, or not an identifier")
    points, pass_mark = float(table["points"]), float(table["pass_mark"])
    if not 0 < pass_mark <= points:
        raise ValueError(f"the pass mark {pass_mark:g} is not between 0 and {points:g} points")
    hints = tuple(Hint(tuple(hint["for"]), str(hint["text"])) for hint in table.get("hints", []))
    diagnoses = _diagnoses(table.get("diagnoses", {}))
    texts = {name: table[name] for name in _TEXTS}
    goal = {name: str(table.get(name, "")) for name in ("class_name", "variable")}
    if bool(goal["class_name"]) == bool(goal["variable"]):
        raise ValueError("it needs either a 'class_name' or a 'variable'")
    seed = table.get("seed")
    if seed is not None and not isinstance(seed, int):
        raise ValueError("'seed' is not a whole number")
    limits = Limits.from_mapping(table.get("limits", {}))
    return Exercise(
        folder=folder,
        order=int(table["order"]),
        points=points,
        pass_mark=pass_mark,
        limits=limits,
        hints=hints,
        diagnoses=diagnoses,
        seed=seed,
        sentences=sentences.read(table.get("sentences", [])),
        **goal,
        **texts,
    )


def _diagnoses(tables: object) -> dict[str, Diagnosis]:
    if not isinstance(tables, dict) or not all(isinstance(fields, dict) for fields in tables.values()):
        raise ValueError("'diagnoses' has to hold a table for each code")
    return {code: catalogue.reworded(code, fields) for code, fields in tables.items()}

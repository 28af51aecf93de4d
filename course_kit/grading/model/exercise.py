"""An exercise's folder: what stands in its exercise.toml, checked when it is read."""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

from course_kit.grading.diagnosis import catalogue
from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise_folders, sentences
from course_kit.grading.model.exercise_folders import FoundExercises
from course_kit.grading.model.limits import Limits
from course_kit.ros.names import did_you_mean, from_root

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from course_kit.grading.diagnosis.catalogue import Diagnosis
    from course_kit.grading.model.plain_data import Record
    from course_kit.grading.model.sentences import Sentence

FORMAT_VERSION = 1
_IDENTIFIER = re.compile(r"[a-z][a-z0-9_]*\Z")
_TEXTS = ("id", "title", "starter", "notebook")
ENDPOINT_KINDS = ("service", "action", "publisher", "subscription")
_OWN_MODULE = ".py"  # what the name of a grader ends in that lies in the exercise's folder


@dataclass(frozen=True)
class Hint:
    """One rung of the ladder, and what it helps with: ids of checks (`*_reason` means all that end so), diagnoses."""

    topics: tuple[str, ...]
    text: str


@dataclass(frozen=True)
class Exercise:
    """One exercise."""

    folder: Path  # where it lies
    id: str  # its name, which is the folder's
    title: str  # for people
    order: int  # its place in the course
    points: float  # full marks
    pass_mark: float  # the points from which it is passed
    starter: str  # the file name of the starter program
    notebook: str  # the file name of its notebook
    solution: Path  # the file with its solution, which may be missing, as in a student edition
    grader: str  # the module or file with checks in Python, see `workers.grader_module`
    class_name: str  # the Node class a submission defines
    variable: str  # what a submission sets instead, in exercises without ROS
    seed: int | None  # what the checks draw from when nobody gives a seed; drawn itself when None
    limits: Limits  # what a submission may use
    hints: tuple[Hint, ...]  # the ladder, from a nudge to a push
    diagnoses: Mapping[str, Diagnosis]  # by code, those that it words in its own way or links elsewhere
    sentences: tuple[Sentence, ...] = ()  # its task, sentence by sentence
    endpoints: tuple[Record, ...] = ()  # what a submission's node offers, publishes and subscribes to
    practice: bool = False  # whether it counts for nothing: a drill
    symptom: str = ""  # of a drill, what somebody who uses its program sees

    @property
    def interfaces(self) -> str:
        """The folder with the interfaces it brings, laid out package/kind/Name.kind; empty when it brings none."""
        folder = self.folder.absolute() / exercise_folders.INTERFACES
        return str(folder) if folder.is_dir() else ""

    def ladder(self, topic: str) -> tuple[str, ...]:
        """The hints for a check or a diagnosis, from a nudge to a push; empty when there are none."""
        return tuple(hint.text for hint in self.hints if any(fnmatchcase(topic, name) for name in hint.topics))

    def diagnosis(self, code: str | None) -> Diagnosis | None:
        """A diagnosis as this exercise words it, else as the catalogue does; None when there is none of this code."""
        found = self.diagnoses.get(code or "") or catalogue.catalogue().get(code or "")
        if found is None or found.notebook:
            return found
        return replace(found, notebook=exercise_folders.in_course(self.folder, self.notebook))


def find_exercises_folder() -> Path:
    """The course's folder of exercises."""
    folder = exercise_folders.course_folder()
    if folder is None:
        raise GradingError("There is no exercises folder here. Run this from a clone of the course.")
    return folder


def find_exercises(folder: Path | None = None) -> FoundExercises:
    """Where the exercises lie."""
    if folder is not None:
        return FoundExercises(exercise_folders.within(folder))
    found = exercise_folders.find()
    if not found.folders and not found.problems:
        find_exercises_folder()
    return found


def list_exercise_ids(folder: Path | None = None) -> list[str]:
    """The ids of all exercises, in the alphabet's order."""
    return sorted(find_exercises(folder).folders)


def load_exercise(exercise_id: str, folder: Path | None = None) -> Exercise:
    """Read one exercise."""
    found = find_exercises(folder)
    drills = exercise_folders.drills(folder)
    places = found.folders.get(exercise_id, ()) or drills.get(exercise_id, ())
    if not places:
        known = sorted(found.folders)
        guess = did_you_mean(exercise_id, [*known, *sorted(drills)])
        there_are = f"There is no exercise '{exercise_id}'.{guess} There are: {', '.join(known) or 'none'}."
        raise GradingError(" ".join((there_are, *found.problems)))
    if exercise_id in found.doubles:
        raise GradingError(found.doubles[exercise_id])
    return read_exercise(places[0])


def read_exercise(folder: Path) -> Exercise:
    """Read the exercise in a folder."""
    table = read_exercise_table(folder)
    try:
        return _parse(table, folder)
    except (ValueError, KeyError, TypeError) as problem:
        raise _unusable(folder, problem) from problem


def read_exercise_table(folder: Path) -> Record:
    """All that stands in the exercise.toml of a folder."""
    try:
        return tomllib.loads((folder / exercise_folders.TOML).read_text(encoding="utf-8"))
    except (OSError, ValueError) as problem:
        raise _unusable(folder, problem) from problem


def _unusable(folder: Path, problem: Exception) -> GradingError:
    what = f"'{problem.args[0]}' is missing" if isinstance(problem, KeyError) else problem
    return GradingError(f"{folder / exercise_folders.TOML} cannot be used: {what}.")


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
    texts: dict[str, Any] = {name: table[name] for name in _TEXTS}
    goal: dict[str, Any] = {name: str(table.get(name, "")) for name in ("class_name", "variable")}
    if bool(goal["class_name"]) == bool(goal["variable"]):
        raise ValueError("it needs either a 'class_name' or a 'variable'")
    seed = table.get("seed")
    if seed is not None and not isinstance(seed, int):
        raise ValueError("'seed' is not a whole number")
    practice = table.get("practice", False)
    if not isinstance(practice, bool):
        raise ValueError("'practice' is neither true nor false")  # noqa: TRY004 - a file's mistakes are all of one kind
    return Exercise(
        folder=folder,
        order=int(table["order"]),
        points=points,
        pass_mark=pass_mark,
        limits=Limits.from_mapping(table.get("limits", {})),
        hints=hints,
        diagnoses=_diagnoses(table.get("diagnoses", {})),
        seed=seed,
        solution=find_solution(table, folder),
        grader=_grader(table, folder),
        sentences=sentences.read(table.get("sentences", [])),
        endpoints=_endpoints(table.get("endpoints", [])),
        practice=practice,
        symptom=str(table.get("symptom", "")),
        **goal,
        **texts,
    )


def _grader(table: Record, folder: Path) -> str:
    """What checks it: a module, or a file of its folder."""
    if "checks" in table:
        raise ValueError("checks are written in Python now, in a file that 'grader' names, instead of [[checks]]")
    grader = table["grader"]
    if not isinstance(grader, str) or not grader:
        raise ValueError("'grader' is not a text")
    if not grader.endswith(_OWN_MODULE):
        return grader
    if not (folder / grader).is_file():
        raise ValueError(f"the grader {grader} is not there")
    if not (folder / grader).resolve().is_relative_to(folder.resolve()):
        raise ValueError(f"the grader {grader} lies outside of the exercise's folder")
    return str(folder.absolute() / grader)


def find_solution(table: Record, folder: Path) -> Path:
    """Where the solution lies: the course's own beside all exercises, in a folder that a release leaves out."""
    named = table.get("solution")
    if named is None:
        return folder.parent.parent / "solutions" / folder.name / str(table["starter"])
    if not isinstance(named, str) or not named:
        raise ValueError("'solution' is not a text")
    return folder / named


def _endpoints(tables: object) -> tuple[Record, ...]:
    """The `[[endpoints]]`: each has a kind, a full name and a type."""
    if not isinstance(tables, list) or not all(isinstance(one, dict) for one in tables):
        raise ValueError("'endpoints' has to be written as [[endpoints]]")
    for one in tables:
        if set(one) != {"kind", "name", "type"} or one["kind"] not in ENDPOINT_KINDS:
            kinds = ", ".join(ENDPOINT_KINDS)
            raise ValueError(f"the endpoint {one.get('name', one)} needs a name, a type, and a kind out of {kinds}")
    return tuple({**one, "name": from_root(str(one["name"]))} for one in tables)


def _diagnoses(tables: object) -> dict[str, Diagnosis]:
    if not isinstance(tables, dict) or not all(isinstance(fields, dict) for fields in tables.values()):
        raise ValueError("'diagnoses' has to hold a table for each code")
    return {code: catalogue.reworded(code, fields) for code, fields in tables.items()}

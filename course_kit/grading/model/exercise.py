"""An exercise's folder: what stands in its exercise.toml, checked when it is read."""

from __future__ import annotations

import dataclasses
import sys
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias

import msgspec
from msgspec import structs

from course_kit.grading.errors import GradingError
from course_kit.grading.model import catalogue, exercise_folders
from course_kit.grading.model.exercise_folders import FoundExercises
from course_kit.grading.model.limits import Limits
from course_kit.grading.model.plain_data import Record, convert_record
from course_kit.ros.names import did_you_mean, from_root

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from course_kit.grading.model.catalogue import Diagnosis

FORMAT_VERSION = 1
_Text: TypeAlias = Annotated[str, msgspec.Meta(min_length=1)]
_Identifier: TypeAlias = Annotated[str, msgspec.Meta(pattern=r"\A[a-z][a-z0-9_]*\Z")]  # small letters, digits and _
_FileName: TypeAlias = Annotated[str, msgspec.Meta(pattern=r"\A\w[\w.-]*\.(?:py|yaml)\Z")]
_OWN_MODULE = ".py"  # what the name of a grader ends in that lies in the exercise's folder


class Hint(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One rung of the ladder, and what it helps with: ids of checks (`*_reason` means all that end so), diagnoses."""

    topics: tuple[str, ...] = msgspec.field(name="for")
    text: str = msgspec.field()


class Sentence(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One thing that a learner reads in the notebook and in the starter; checks name what they prove by their ids."""

    id: _Identifier
    # In Markdown, one or more sentences that are tested together, or a row of a table (`| a | b |`).
    text: Annotated[str, msgspec.Meta(pattern=r"\S")]
    heading: str = ""  # begins a new paragraph with these words; above a row of a table the header of a new table
    # The id of the notebook's cell in which it and those after it stand; that of the one before when empty.
    cell: str = ""
    freedom: str = ""  # for a sentence that grants a freedom, the right program of the proof set that makes use of it

    @property
    def is_row(self) -> bool:
        """Whether it is a row of a table."""
        return self.text.startswith("|")

    def without_margins(self) -> Sentence:
        """The same without the ends of lines that TOML keeps around a text."""
        return Sentence(*(text.strip() for text in structs.astuple(self)))


class _Endpoint(msgspec.Struct, forbid_unknown_fields=True):
    kind: Literal["service", "action", "publisher", "subscription"]
    name: str
    type: str
    program: str = ""  # the one of the exercise's files whose node has it; empty where there is one program


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
    solution: Path  # the file, or folder of files, with its solution, which may be missing, as in a student edition
    grader: str  # the module or file with checks in Python, see `workers.grader_module`
    class_name: str  # the Node class a submission defines
    variable: str  # what a submission sets instead, in exercises without ROS
    files: tuple[str, ...]  # the names of all files of a submission, where it has several
    launch_file: str  # the one of them that starts the others together
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

    @property
    def starters(self) -> tuple[str, ...]:
        """The names of all files that a learner begins with."""
        return (*(self.files or (self.starter,)), self.notebook)

    @property
    def asks_for(self) -> str:
        """What a submission holds, in words."""
        return self.class_name or self.variable or ", ".join(self.files)

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
        return _make_exercise(table, folder)
    except ValueError as problem:
        raise _unusable(folder, problem) from problem


def read_exercise_table(folder: Path) -> Record:
    """All that stands in the exercise.toml of a folder."""
    try:
        return tomllib.loads((folder / exercise_folders.TOML).read_text(encoding="utf-8"))
    except (OSError, ValueError) as problem:
        raise _unusable(folder, problem) from problem


def _unusable(folder: Path, problem: Exception) -> GradingError:
    return GradingError(f"{folder / exercise_folders.TOML} cannot be used: {problem}.")


class _Table(msgspec.Struct):
    """What stands in an exercise.toml; for what it is about see `Exercise`."""

    format_version: int
    id: _Identifier
    title: _Text
    order: int
    points: float
    pass_mark: float
    notebook: _Text
    grader: _Text
    starter: str = ""
    class_name: str = ""
    variable: str = ""
    files: tuple[_FileName, ...] = ()
    launch_file: str = ""
    seed: int | None = None
    practice: bool = False
    symptom: str = ""
    solution: _Text | None = None
    limits: dict[str, int | float] = {}
    hints: tuple[Hint, ...] = ()
    diagnoses: dict[str, dict[str, str]] = {}
    sentences: tuple[Sentence, ...] = ()
    endpoints: tuple[_Endpoint, ...] = ()


def _make_exercise(fields: Record, folder: Path) -> Exercise:
    if "checks" in fields:
        raise ValueError("checks are written in Python now, in a file that 'grader' names, instead of [[checks]]")
    if fields.get("format_version") != FORMAT_VERSION:
        version = fields.get("format_version")
        raise ValueError(f"its format_version is {version}, but this kit reads {FORMAT_VERSION}")
    table = convert_record(fields, _Table)
    if table.id != folder.name:
        raise ValueError(f"its id '{table.id}' is not the name of its folder")
    if not 0 < table.pass_mark <= table.points:
        raise ValueError(f"the pass mark {table.pass_mark:g} is not between 0 and {table.points:g} points")
    if sum(map(bool, (table.class_name, table.variable, table.files))) != 1:
        raise ValueError("it needs either a 'class_name' or a 'variable', or 'files'")
    if not (table.starter or table.files):
        raise ValueError("'starter' is missing")
    if table.launch_file not in ("", *table.files):
        raise ValueError(f"the launch file {table.launch_file} is none of its files")
    names = [sentence.id for sentence in table.sentences]
    if doubles := sorted({name for name in names if names.count(name) > 1}):
        raise ValueError(f"two sentences have the id '{doubles[0]}'")
    in_course = folder.parent.parent / "solutions" / folder.name  # which a release leaves out
    if not table.files:
        in_course /= table.starter
    read: Record = {
        "folder": folder,
        "starter": table.starter or table.files[0],
        "solution": in_course if table.solution is None else folder / table.solution,
        "grader": _find_grader(table.grader, folder),
        "limits": convert_record(table.limits, Limits),
        "diagnoses": {code: catalogue.reword_diagnosis(code, texts) for code, texts in table.diagnoses.items()},
        "sentences": tuple(sentence.without_margins() for sentence in table.sentences),
        "endpoints": tuple({**structs.asdict(one), "name": from_root(one.name)} for one in table.endpoints),
    }
    same: Record = {
        field.name: getattr(table, field.name) for field in dataclasses.fields(Exercise) if field.name not in read
    }
    return Exercise(**read, **same)


def _find_grader(grader: str, folder: Path) -> str:
    """What checks it: a module, or a file of its folder."""
    if not grader.endswith(_OWN_MODULE):
        return grader
    if not (folder / grader).is_file():
        raise ValueError(f"the grader {grader} is not there")
    if not (folder / grader).resolve().is_relative_to(folder.resolve()):
        raise ValueError(f"the grader {grader} lies outside of the exercise's folder")
    return str(folder.absolute() / grader)

"""An exercise's folder: what stands in its exercise.toml, checked when it is read."""

from __future__ import annotations

from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path  # noqa: TC003 - msgspec looks it up
from typing import TYPE_CHECKING, Annotated, TypeAlias

import msgspec
from msgspec import structs

from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.catalogue import DiagnosisWords, catalogue
from course_kit.grading.model.job import ExerciseEndpoint  # noqa: TC001 - as above
from course_kit.grading.model.limits import Limits
from course_kit.grading.model.plain_data import convert_record
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from course_kit.grading.model.catalogue import Diagnosis

FORMAT_VERSION = 1
_Text: TypeAlias = Annotated[str, msgspec.Meta(min_length=1)]
_Identifier: TypeAlias = Annotated[str, msgspec.Meta(pattern=r"\A[a-z][a-z0-9_]*\Z")]  # small letters, digits and _
_FileName: TypeAlias = Annotated[str, msgspec.Meta(pattern=r"\A\w[\w.-]*\.(?:py|yaml)\Z")]
_OWN_MODULE = ".py"  # what the name of a grader ends in that lies in the exercise's folder
_OF_THE_KIT = "course_kit."  # and what that of every other one begins with


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

    def __post_init__(self) -> None:
        """Take away the ends of lines that TOML keeps around a text."""
        for name in self.__struct_fields__:
            structs.force_setattr(self, name, getattr(self, name).strip())


class Exercise(msgspec.Struct, frozen=True, kw_only=True):
    """One exercise: what stands in its exercise.toml, and where that lies."""

    folder: Path
    id: _Identifier  # its name, which is the folder's
    title: _Text  # for people
    order: int  # its place in the course
    points: float  # full marks
    pass_mark: float  # the points from which it is passed
    notebook: _Text  # the file name of its notebook
    written_grader: _Text = msgspec.field(name="grader")
    written_starter: str = msgspec.field(name="starter", default="")
    written_solution: str = msgspec.field(name="solution", default="")
    class_name: str = ""  # the Node class a submission defines
    variable: str = ""  # what a submission sets instead, in exercises without ROS
    files: tuple[_FileName, ...] = ()  # the names of all files of a submission, where it has several
    parts: tuple[_Identifier, ...] = ()  # what its checks' ids begin with, where each part is graded by itself
    seed: int | None = None  # what the checks draw from when nobody gives one; None: what the program's text gives
    limits: Limits = Limits()  # what a submission may use
    hints: tuple[Hint, ...] = ()  # the ladder, from a nudge to a push
    diagnoses: dict[str, DiagnosisWords] = {}  # by code, those that it words in its own way or links elsewhere
    sentences: tuple[Sentence, ...] = ()  # its task, sentence by sentence
    endpoints: tuple[ExerciseEndpoint, ...] = ()  # what a submission's node offers, publishes and subscribes to
    practice: bool = False  # whether it has no points: a drill
    symptom: str = ""  # of a drill, what somebody who uses its program sees

    @property
    def starter(self) -> str:
        """The file name of the starter program."""
        return self.written_starter or self.files[0]

    @property
    def solution(self) -> Path:
        """The file, or folder of files, with its solution, which may be missing, as in a student edition."""
        if self.written_solution:
            return self.folder / self.written_solution
        in_course = self.folder.parent.parent / exercise_folders.SOLUTIONS / self.folder.name
        return in_course if self.files else in_course / self.starter

    @property
    def grader(self) -> str:
        """The module or file with checks in Python, see `workers.exercise_job`."""
        own = self.written_grader.endswith(_OWN_MODULE)
        return str(self.folder.absolute() / self.written_grader) if own else self.written_grader

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

    def hints_for(self, check: str, found: Diagnosis | None) -> tuple[str, ...]:
        """The hints for a failed check: those for it and its cause, those for the cause, else the kit's, its ladder."""
        of_cause, of_check = self.ladder(found.code) if found else (), self.ladder(check)
        of_kit = (found.hint,) if found and not of_cause else ()
        if of_both := tuple(hint for hint in of_cause if hint in of_check):  # those of other checks are not about this
            of_others = {hint.text for hint in self.hints if any("." not in topic for topic in hint.topics)}
            of_cause = tuple(hint for hint in of_cause if hint not in of_others)
        early = () if exercise_folders.is_added(self.folder) else of_kit
        return tuple(dict.fromkeys((*of_both, *of_cause, *early, *of_check, *of_kit)))

    def diagnosis(self, code: str | None) -> Diagnosis | None:
        """A diagnosis as this exercise words it, else as the catalogue does; None if the code is unknown."""
        found = catalogue().get(code or "")
        if found is None:
            return None
        if own := self.diagnoses.get(found.code):
            found = replace(found, **msgspec.to_builtins(own))
        if found.notebook:
            return found
        return replace(found, notebook=exercise_folders.in_course(self.folder, self.notebook))


def list_exercise_ids(folder: Path | None = None) -> list[str]:
    """The ids of all exercises, in the alphabet's order."""
    return sorted(exercise_folders.find_exercises(folder).folders)


def load_exercise(exercise_id: str, folder: Path | None = None) -> Exercise:
    """Read one exercise."""
    found = exercise_folders.find_exercises(folder)
    places = found.folders.get(exercise_id, ()) or found.drills.get(exercise_id, ())
    if not places:
        known = sorted(found.folders)
        guess = did_you_mean(exercise_id, [*known, *sorted(found.drills)])
        there_are = f"There is no exercise '{exercise_id}'.{guess} Exercises: {', '.join(known) or 'none'}."
        raise GradingError(" ".join((there_are, *found.problems)))
    if len(places) > 1:
        raise GradingError(
            f"There are {len(places)} exercises '{exercise_id}': in {' and in '.join(map(str, places))}. Rename one, "
            f"its folder and the id in its {exercise_folders.TOML}, or leave one out."
        )
    return read_exercise(places[0])


def read_exercise(folder: Path) -> Exercise:
    """Read the exercise in a folder."""
    toml = folder / exercise_folders.TOML
    try:
        table = msgspec.toml.decode(toml.read_text(encoding="utf-8"), type=dict)
        if (version := table.get("format_version")) != FORMAT_VERSION:
            raise ValueError(f"its format_version is {version}, but this kit reads {FORMAT_VERSION}")  # noqa: TRY301
        exercise = convert_record({**table, "folder": folder}, Exercise)
        _require_sense(exercise)
    except (OSError, ValueError) as problem:
        raise GradingError(f"{toml} cannot be used: {problem}.") from problem
    return exercise


def _require_sense(exercise: Exercise) -> None:
    """What stands in an exercise.toml makes sense together."""
    folder, grader = exercise.folder, exercise.written_grader
    own = grader if grader.endswith(_OWN_MODULE) else ""
    own_files = [(folder / name).resolve() for name in (own, exercise.written_solution)]
    outside = [str(path) for path in own_files if not path.is_relative_to(folder.resolve())]
    names = [sentence.id for sentence in exercise.sentences]
    answers = [kind for kind in (exercise.class_name, exercise.variable, exercise.files) if kind]
    for is_wrong, what in (
        (exercise.id != folder.name, f"its id '{exercise.id}' is not the name of its folder"),
        (
            not 0 < exercise.pass_mark <= exercise.points,
            f"the pass mark {exercise.pass_mark:g} is not between 0 and {exercise.points:g} points",
        ),
        (len(answers) != 1, "it needs either a 'class_name' or a 'variable', or 'files'"),
        (not (exercise.written_starter or exercise.files), "'starter' is missing"),
        (len(set(names)) < len(names), f"two sentences have the id '{max(names, key=names.count, default='')}'"),
        (not (own or grader.startswith(_OF_THE_KIT)), f"the grader {grader} is no .py file in the exercise's folder"),
        (not (folder / own).exists(), f"the grader {own} is not there"),
        (outside, f"{', '.join(outside)} lies outside of the exercise's folder"),
    ):
        if is_wrong:
            raise ValueError(what)
    for code, words in exercise.diagnoses.items():
        words.require_sense(code)

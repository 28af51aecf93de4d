"""What a worker is asked to do for an exercise, a submission, a command or a running node; and what checks it.

A grader is the module or the file that an exercise.toml names; only trusted processes load it. A file is loaded by its
path, as a module of a new package: what lies beside it is imported as `from .helpers import ...`.

No submission may see the folder of an exercise that was added, among Python's libraries, either.
"""

from __future__ import annotations

import importlib
import os
import shlex
import shutil
import sys
import traceback
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.job import Job
from course_kit.grading.model.submission import Submission
from course_kit.interfaces import get_type
from course_kit.interfaces.sources import PATH_VARIABLE, path_with
from course_kit.text.console import in_points

if TYPE_CHECKING:
    from course_kit.grading.checks.check import Check
    from course_kit.grading.model.exercise import Exercise

_TINY = 1e-6  # points


def make_job_of_node(exercise: Exercise, seed: int, command: str | None = None) -> Job:
    """The job of grading a node that is no program of ours to start."""
    folders = [folder.resolve() for folder in (exercise.folder, *exercise_folders.added_exercises())]
    solutions = (folder.parent.parent / exercise_folders.SOLUTIONS for folder in folders)
    job = Job(
        exercise.grader,
        "attach",
        seed,
        class_name=exercise.class_name,
        # a drill's program runs: without its start it would be another one; one of several starts itself, too
        own_start=exercise.practice or bool(exercise.files),
        variable=exercise.variable,
        limits=exercise.limits,
        hidden=tuple(dict.fromkeys(map(str, (*folders, *solutions)))),
        interfaces=exercise.interfaces,
        points=exercise.points,
        endpoints=exercise.endpoints,
    )
    if command is None:
        return job
    try:
        words = tuple(shlex.split(command))
    except ValueError as problem:
        raise GradingError(f"The command cannot be read as a shell would: {problem}.") from None
    if not words or shutil.which(words[0]) is None:
        raise GradingError(f"--exec cannot start '{command}': there is no such program. Check its name.")
    text = Submission(words[0], words[0], "")
    return replace(job, mode="exec", text=text, command=words, folder=str(Path.cwd()))


def checks_of(exercise: Exercise, seed: int) -> list[Check]:
    """The checks of an exercise, loaded into this process."""
    job = make_job_of_node(exercise, seed)
    return checks_of_grader(load_grader(job), job)


def load_grader(job: Job) -> Any:
    """The grader of a job, which has `CHECKS` or makes them; with the interfaces of the job's endpoints."""
    from rclpy.type_support import check_for_type_support

    if job.interfaces:
        os.environ[PATH_VARIABLE] = path_with(job.interfaces)  # of this process and those it starts
    path = Path(job.grader)
    found = python_module(path) if path.is_absolute() else importlib.import_module(job.grader)
    if not hasattr(found, "CHECKS") and not hasattr(found, "checks_for"):
        raise GradingError(f"{path} has neither CHECKS, a list of checks, nor checks_for(job), which makes one")
    for end in job.endpoints:
        check_for_type_support(get_type(end.type))
    return found


def checks_of_grader(grader: Any, job: Job) -> list[Check]:
    """The checks of an exercise."""
    made = list(grader.checks_for(job) if hasattr(grader, "checks_for") else grader.CHECKS)
    worth = sum(check.points for check in made)
    if job.points and abs(worth - job.points) > _TINY:
        raise GradingError(f"the checks are worth {in_points(worth)} together, but the exercise {job.points:g}")
    return made


def python_module(path: Path) -> ModuleType:
    """The module in a file of an exercise's folder."""
    package = f"exercise_{hash(path.parent):x}"
    if package not in sys.modules:
        made = ModuleType(package)
        made.__path__ = [str(path.parent)]
        sys.modules[package] = made
    writes, sys.dont_write_bytecode = sys.dont_write_bytecode, True  # no __pycache__ in the exercise's folder
    try:
        return importlib.import_module(f"{package}.{path.stem}")
    except Exception as problem:
        raise GradingError(f"{_place(path, problem)} cannot be run: {type(problem).__name__}: {problem}") from problem
    finally:
        sys.dont_write_bytecode = writes


def _place(path: Path, problem: Exception) -> str:
    """The file, and the last line of it that was run."""
    if isinstance(problem, SyntaxError) and problem.filename:
        return f"{problem.filename}, line {problem.lineno},"
    lines = [frame.lineno for frame in traceback.extract_tb(problem.__traceback__) if frame.filename == str(path)]
    return f"{path}, line {lines[-1]}," if lines else str(path)

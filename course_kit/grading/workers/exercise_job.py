"""What a worker is asked to do for an exercise: the job of grading a submission, a command, or a running node.

What no submission may see lies anywhere, among Python's libraries, too: the folder of each exercise that was added; and
where they lie elsewhere, its solution and its grader.
"""

from __future__ import annotations

import os
import shlex
import shutil
import sys
from contextlib import suppress
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import read_exercise
from course_kit.grading.model.job import Job
from course_kit.grading.workers import grader_module

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.grading.checks.check import Check
    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.submission import Submission

_KIT = __name__.partition(".")[0]


def make_job(exercise: Exercise, text: Submission, seed: int) -> Job:
    """The job of grading a program."""
    return replace(
        make_job_of_node(exercise, seed),
        mode="run",
        name=text.program,
        source=text.source,
        fault=text.problem,
        places=text.places,
        facts=text.facts,
        literal=text.literal,
        files=text.files,
    )


def make_job_of_node(exercise: Exercise, seed: int, command: str | None = None) -> Job:
    """The job of grading a node that is no program of ours to start."""
    job = Job(
        exercise.grader,
        "attach",
        "",
        seed,
        class_name=exercise.class_name,
        # a drill's program runs: without its start it would be another one; one of several starts itself, too
        own_start=exercise.practice or bool(exercise.files),
        variable=exercise.variable,
        limits=exercise.limits,
        hidden=hidden_files_of(exercise),
        interfaces=exercise.interfaces,
        points=exercise.points,
        endpoints=tuple(msgspec.to_builtins(exercise.endpoints)),
        launch_file=exercise.launch_file,
    )
    if command is None:
        return job
    try:
        words = tuple(shlex.split(command))
    except ValueError as problem:
        raise GradingError(f"The command cannot be read as a shell would: {problem}.") from None
    if not words or shutil.which(words[0]) is None:
        raise GradingError(f"--exec cannot start '{command}': there is no such program. Check its name.")
    return replace(job, mode="exec", name=words[0], command=words, folder=str(Path.cwd()))


def checks_of(exercise: Exercise, seed: int) -> list[Check]:
    """The checks of an exercise, loaded into this process."""
    job = make_job_of_node(exercise, seed)
    return grader_module.checks_of(grader_module.load_for(job), job)


def hidden_files_of(exercise: Exercise) -> tuple[str, ...]:
    """The real paths of files and folders that the submissions of an exercise may not see."""
    exercises = exercise_folders.added_exercises()
    found = [folder.resolve() for folder in (exercise.folder, *exercises)]
    found += files_beside(exercise.solution, exercise.grader)
    for folder in exercises:
        with suppress(OSError, GradingError, KeyError, ValueError):  # said where that exercise is asked for
            brought = read_exercise(folder)
            found += files_beside(brought.solution, brought.grader)
    return tuple(dict.fromkeys(map(str, found)))


def files_beside(solution: Path, grader: str) -> list[Path]:
    """What belongs to an exercise and lies outside of its folder."""
    around = solution.resolve().parent
    found = [*_with_bytecode(solution.resolve())] if _is_of_libraries(around) else [around]
    top = grader.partition(".")[0]
    if top.isidentifier() and top != _KIT:  # of the kit no submission sees a grader anyhow
        with suppress(ImportError, ValueError):
            spec = find_spec(top)
            if spec is not None and spec.submodule_search_locations:
                packages = (Path(folder).resolve() for folder in spec.submodule_search_locations)
                found += [place for place in packages if not _is_of_libraries(place)]
            elif spec is not None and spec.origin and spec.has_location:
                found += _with_bytecode(Path(spec.origin).resolve())
    return found


def _with_bytecode(module: Path) -> Iterator[Path]:
    """A file, and what Python has written of it beside it."""
    yield module
    yield from module.parent.glob(f"__pycache__/{module.stem}.*.pyc")


def _is_of_libraries(folder: Path) -> bool:
    """Whether Python looks for modules in it or below it, so that hiding it would hide them, too."""
    return any(Path(entry).resolve().is_relative_to(folder) for entry in sys.path if os.path.isabs(entry))  # noqa: PTH117

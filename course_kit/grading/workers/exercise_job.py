"""What a worker is asked to do for an exercise: the job of grading a submission, a command, or a running node."""

from __future__ import annotations

import shlex
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.grading.model.job import Job
from course_kit.grading.sandbox import hidden_files
from course_kit.grading.workers import grader_module

if TYPE_CHECKING:
    from course_kit.grading.checks.check import Check
    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.submission import Submission


def of_submission(exercise: Exercise, text: Submission, seed: int) -> Job:
    """The job of grading a program."""
    return replace(
        of_running(exercise, seed),
        mode="run",
        name=text.program,
        source=text.source,
        fault=text.problem,
        places=text.places,
        facts=text.facts,
        literal=text.literal,
        files=text.files,
    )


def of_running(exercise: Exercise, seed: int, command: str | None = None) -> Job:
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
        hidden=hidden_files.of(exercise),
        interfaces=exercise.interfaces,
        points=exercise.points,
        endpoints=exercise.endpoints,
        launch_file=exercise.launch_file,
    )
    if command is None:
        return job
    try:
        words = tuple(shlex.split(command))
    except ValueError as problem:
        raise GradingError(f"The command cannot be read as a shell would: {problem}.") from None
    if not words:
        raise GradingError("The command after --exec is empty.")
    return replace(job, mode="exec", name=words[0], command=words, folder=str(Path.cwd()))


def checks_of(exercise: Exercise, seed: int) -> list[Check]:
    """The checks of an exercise, loaded into this process."""
    job = of_running(exercise, seed)
    return grader_module.checks_of(grader_module.load_for(job), job)

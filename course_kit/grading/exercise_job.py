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


def of_submission(task: Exercise, text: Submission, seed: int) -> Job:
    """The job of grading a program."""
    return replace(
        of_running(task, seed),
        mode="run",
        name=text.program,
        source=text.source,
        fault=_fault(text),
        places=text.places,
        facts=text.facts,
        literal=text.literal,
    )


def of_running(task: Exercise, seed: int, command: str | None = None) -> Job:
    """The job of grading a node that is no program of ours to start."""
    job = Job(
        task.grader,
        "attach",
        "",
        seed,
        class_name=task.class_name,
        own_start=task.practice,  # a drill's program runs: without its start it would be another one
        variable=task.variable,
        limits=task.limits,
        hidden=hidden_files.of(task),
        interfaces=task.interfaces,
        points=task.points,
        endpoints=task.endpoints,
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


def checks_of(task: Exercise, seed: int) -> list[Check]:
    """The checks of an exercise, loaded into this process."""
    job = of_running(task, seed)
    return grader_module.checks_of(grader_module.load_for(job), job)


def _fault(text: Submission) -> str:
    fault = text.fault
    if fault is None:
        return ""
    where = f" in {text.where(fault.line)}: {fault.text}" if fault.line else ""
    return f"{fault.problem[:1].upper()}{fault.problem[1:]}{where}."

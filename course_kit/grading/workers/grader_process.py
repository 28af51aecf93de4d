"""The grader process: joins the graph, runs the checks of one exercise, reports each as it is known.

What checks an exercise is the module or the file that its exercise.toml names. Only trusted processes load it. A file
is loaded by its path, as a module of a new package: what lies beside it is imported as `from .helpers import ...`.
"""

from __future__ import annotations

import hashlib
import importlib
import os
import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Protocol

from course_kit.grading.checks.check import choose_part, run_all
from course_kit.grading.checks.context import CheckContext
from course_kit.grading.errors import GradingError
from course_kit.grading.model import bounds, limits
from course_kit.grading.sandbox import machine
from course_kit.grading.sandbox.channel import ChannelClosedError
from course_kit.interfaces import get_type
from course_kit.interfaces.sources import PATH_VARIABLE, path_with
from course_kit.process.libc import set_name
from course_kit.text.console import in_points

if TYPE_CHECKING:
    from collections.abc import Sequence
    from mmap import mmap

    from course_kit.grading.checks.check import Check
    from course_kit.grading.model.job import Job
    from course_kit.grading.model.plain_data import Record
    from course_kit.grading.sandbox.channel import Channel

_DIGITS = 16  # hexadecimal
_TINY = 1e-6  # points


def warm_up() -> None:
    """Import what every grading needs. Must not initialise ROS: a context does not survive a fork."""
    import rclpy.action
    import rclpy.executors
    import rclpy.node
    from rcl_interfaces import srv as parameter_services
    from rcl_interfaces.msg import ParameterEvent
    from rclpy.type_support import check_for_type_support
    from type_description_interfaces.srv import GetTypeDescription

    import course_kit.grading.checks.grader_node
    import course_kit.grading.checks.vocabulary

    machine.processor_share()
    for of_every_node in (
        GetTypeDescription,
        ParameterEvent,
        parameter_services.DescribeParameters,
        parameter_services.GetParameters,
        parameter_services.GetParameterTypes,
        parameter_services.ListParameters,
        parameter_services.SetParameters,
        parameter_services.SetParametersAtomically,
    ):
        check_for_type_support(of_every_node)  # else each submission loads it when its node is made
    del rclpy, course_kit


def main(supervisor: Channel, job: Job, lives: mmap) -> None:
    """Run all checks of the job's exercise; returns when each is reported, or why they could not be run."""
    set_name("grade grader")
    os.setpriority(os.PRIO_PROCESS, 0, job.priority)
    limits.bound_reader(job.limits.wall_s)
    record: Record = {"do": "done", "problem": ""}
    try:
        _run(supervisor, job, lives)
    except ChannelClosedError:
        return
    except GradingError as problem:
        record["problem"] = bounds.cut_text(str(problem))
    except Exception as problem:  # noqa: BLE001 - a broken grader or installation; the report says so
        record["problem"] = bounds.cut_text(f"{type(problem).__name__}: {problem}")
    supervisor.send(record)


def _run(supervisor: Channel, job: Job, lives: mmap) -> None:
    grader = load_for(job)
    context = CheckContext(supervisor, job, dict(getattr(grader, "VARIABLES", {})), lives)
    checks = checks_of(grader, job)
    if job.only:
        checks = choose_part(checks, job.only)
    if not (job.fault or job.variable or job.files):
        context.launch()
    try:
        for result in run_all(checks, context):
            supervisor.send({"do": "result", "result": result})
            if job.first_failure and result.status == "failed" and result.max_points:
                break
    finally:
        if not job.isolation.network:  # our own graph ends with us, at once; others wait for those who do not leave
            context.close()


class Grader(Protocol):
    """What a grader is: it has `CHECKS`, or `checks_for(job)`, which makes them of the job's seed."""

    INTERFACES: Sequence[Any]


def load_for(job: Job) -> Grader:
    """The grader of a job, its interfaces and those of the job's endpoints loaded."""
    from rclpy.type_support import check_for_type_support

    if job.interfaces:
        os.environ[PATH_VARIABLE] = path_with(job.interfaces)  # of this process and those it starts
    path = Path(job.grader)
    found: Grader = _of_file(path) if path.is_absolute() else importlib.import_module(job.grader)
    if not hasattr(found, "INTERFACES"):
        found.INTERFACES = ()
    for interface in interfaces_of(found, job):
        check_for_type_support(interface)
    return found


def interfaces_of(grader: Grader, job: Job) -> list[Any]:
    """The classes of all interfaces that the checks of a job use."""
    return [*grader.INTERFACES, *(get_type(end["type"]) for end in job.endpoints)]


def checks_of(grader: Grader, job: Job) -> list[Check]:
    """The checks of an exercise."""
    made: list[Check] = list(grader.checks_for(job) if hasattr(grader, "checks_for") else grader.CHECKS)  # type: ignore[attr-defined]
    worth = sum(check.points for check in made)
    if job.points and abs(worth - job.points) > _TINY:
        raise GradingError(f"the checks are worth {in_points(worth)} together, but the exercise {job.points:g}")
    return made


def _of_file(path: Path) -> Grader:
    found: Any = python_module(path)
    if not hasattr(found, "CHECKS") and not hasattr(found, "checks_for"):
        raise GradingError(f"{path} has neither CHECKS, a list of checks, nor checks_for(job), which makes one")
    graded: Grader = found
    return graded


def python_module(path: Path) -> ModuleType:
    """The module in a file of an exercise's folder."""
    package = f"exercise_{hashlib.sha256(os.fsencode(path.parent)).hexdigest()[:_DIGITS]}"
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

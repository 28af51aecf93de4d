"""`course-kit dev matrix`: the course as a newcomer meets it, on each Python of this machine.

For each of them the course is copied into a temporary folder with a space in its name, `./course doctor` sets it up,
the solutions are graded, and every notebook is run with its outputs compared. artifacts/python_matrix.md has the table.
What this machine lacks is named and left out.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.authoring import course_files
from course_kit.dev import matrix_table, notebooks, pythons
from course_kit.dev.steps import CommandStep, StepResult, StepRunner
from course_kit.grading import exercise
from course_kit.ros2cli import delegation
from course_kit.text.console import cannot

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from course_kit.dev.pythons import Interpreter

ENDS = "--ends"
FAST_TESTS = ("environment", "interfaces", "lab", "panels", "ros2cli")
_TABLE = Path("artifacts/python_matrix.md")
_NOT_INHERITED = (
    "ROS",
    "_ROS",
    "RMW_",
    "RCUTILS_",
    "FAST",
    "AMENT_",
    "COLCON_",
    "COURSE",
    "PYTEST",
    "PYTHON",
    "VIRTUAL",
)
_SET_UP_S, _GRADE_S, _NOTEBOOKS_S, _TESTS_S = 1200.0, 300.0, 1200.0, 3600.0


@dataclass(frozen=True)
class Combination:
    """One Python, and what is tried on it besides set-up, doctor and gradings."""

    python: Interpreter
    notebooks: bool = True
    drills: bool = True  # with the notebooks
    tests: bool = False

    def __str__(self) -> str:
        return f"Python {self.python}"


def main(arguments: Sequence[str]) -> int:
    """Run the command; 0 when nothing has failed, 1 when something has, 2 when it cannot be run."""
    options = _parser().parse_args(arguments)
    root = environment.checkout()
    if root is None:
        return cannot("the matrix belongs to the course's folder; run this in a clone of it.")
    found = pythons.find()
    here = [one.minor for one in found]
    if absent := [version for version in options.python or () if version not in here]:
        return cannot(f"there is no Python {', '.join(absent)} here; there is {', '.join(here)}.")
    uv = pythons.find_uv()
    chosen, notes = choose(found, options, has_uv=uv is not None)
    for note in notes:
        print(f"course: {note}", flush=True)
    results: dict[Combination, list[StepResult]] = {}
    with StepRunner() as runner:
        for combination in chosen:
            results[combination] = run(root, combination, runner, uv)
    table = matrix_table.as_markdown({str(one): ran for one, ran in results.items()}, notes)
    print(f"\n{table}", flush=True)
    environment.write_atomically(root / _TABLE, table, durable=False)
    return 1 if any(result.failed for ran in results.values() for result in ran) else 0


def choose(
    found: Sequence[Interpreter], options: argparse.Namespace, *, has_uv: bool
) -> tuple[list[Combination], list[str]]:
    """What is tried, and sentences about what is not.

    Args:
        found: the Pythons of this machine.
        options: the command line.
        has_uv: whether uv is to be had.
    """
    missing = [version for version in pythons.wanted() if version not in {one.minor for one in found}]
    notes = [f"This machine has no Python {', '.join(missing)}."] if missing else []
    if options.python:
        found = [one for one in found if one.minor in options.python]
    if not has_uv:
        notes += [
            f"Python {one} is left out: it comes without venv, and there is no uv." for one in found if not one.has_venv
        ]
        found = [one for one in found if one.has_venv]
    if options.ends:
        found = [one for one in found if one.version[:2] != sys.version_info[:2]]
        if not found:
            notes.append("It has no other Python than the one of this course, so there is nothing to compare.")
        found = list(dict.fromkeys((*found[:1], *found[-1:])))
    return [Combination(one, drills=not options.ends, tests=options.tests and not options.ends) for one in found], notes


def run(root: Path, combination: Combination, runner: StepRunner, uv: str | None) -> list[StepResult]:
    """Everything on one combination; where the set-up fails the rest is not run.

    Args:
        root: the course's folder.
        combination: the Python.
        runner: runs the steps.
        uv: the program, where there is one.
    """
    print(f"\ncourse: {combination}", flush=True)
    with tempfile.TemporaryDirectory(prefix="course matrix ", ignore_cleanup_errors=True) as folder:
        course = Path(folder) / "my course"
        copy(root, course)
        environ = environ_of(combination, Path(folder), uv)
        results = [runner.run(CommandStep("set-up and doctor", ["./course", "doctor"], _SET_UP_S), course, environ)]
        if not results[0].failed:
            results += [runner.run(step, course, environ) for step in steps_of(combination, course)]
        runner.end_all()  # a daemon of `ros2` may be left, and its folder goes away now
        return results


def steps_of(combination: Combination, course: Path) -> Iterator[CommandStep]:
    """What follows the set-up of a course."""
    for name in exercise.ids(course / "exercises"):
        solution = Path("solutions", name, f"{name}.py")
        if (course / solution).is_file():  # the student edition has none
            command = ["./course", "grade", name, str(solution), "--format", "json"]
            yield CommandStep(name, command, _GRADE_S, full_marks)
    if combination.notebooks:
        install = [str(course / ".venv/bin/python"), "-m", "pip", "install", "--quiet", notebooks.requirement()]
        yield CommandStep("nbval", install, _SET_UP_S)
        chosen = [] if combination.drills else [str(path) for path in notebooks.with_outputs(course, drills=False)]
        yield CommandStep("notebooks", ["./course", "dev", "notebooks", *chosen], _NOTEBOOKS_S)
    if combination.tests:
        tests = [f"tests/{name}" for name in FAST_TESTS]
        yield CommandStep("tests", ["./course", "test", "-q", "-n", "2", "--dist", "loadfile", *tests], _TESTS_S)


def full_marks(output: str) -> str:
    """What is wrong with a report of a right solution; nothing if it is as it has to be."""
    try:
        report = json.loads(output[output.index("{") :])
        score, most = report["score"], report["max_score"]
    except (ValueError, KeyError):
        return "there is no report."
    return "" if score == most else f"{score:g} of {most:g} points."


def copy(root: Path, target: Path) -> None:
    """Copy the course as it is now: what git knows or would be told of, without anything generated."""
    for name in course_files.own_files(root, new=True):
        path = target / name
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(root / name, path)


def environ_of(combination: Combination, folder: Path, uv: str | None) -> dict[str, str]:
    """The environment of somebody who has never seen the course, whose state goes into the temporary folder.

    Args:
        combination: the Python.
        folder: the temporary folder.
        uv: the program, where there is one.
    """
    environ = delegation.clean_environment({**os.environ})
    environ = {name: value for name, value in environ.items() if not name.startswith(_NOT_INHERITED)}
    ours = Path(sys.executable).parent
    path = [one for one in environ.get("PATH", os.defpath).split(os.pathsep) if not one or Path(one) != ours]
    state = folder / "state"
    environ.update(
        COURSE_PYTHON=combination.python.path,
        COURSE_KIT_PROGRESS="off",
        XDG_STATE_HOME=str(state),
        IPYTHONDIR=str(state / "ipython"),
        JUPYTER_RUNTIME_DIR=str(state / "jupyter"),
    )
    if uv is not None:
        tools = folder / "tools"
        tools.mkdir()
        (tools / "uv").symlink_to(uv)
        path.insert(0, str(tools))
    environ["PATH"] = os.pathsep.join(path)
    return environ


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="course-kit dev matrix",
        description="Set the course up on each Python of this machine, grade the solutions and run the notebooks.",
    )
    parser.add_argument("--python", action="append", metavar="VERSION", help="only this one, such as 3.12; repeatable")
    parser.add_argument("--tests", action="store_true", help="the fast tests, too")
    parser.add_argument(
        ENDS, action="store_true", help="only the oldest and the newest Python besides this one, as CI does"
    )
    return parser

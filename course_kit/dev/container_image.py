"""`course-kit dev container`: builds the Containerfile and tries in it what a learner and an instructor do.

With podman, docker or buildah, whichever is here: doctor, the solutions of all exercises, lesson 1, a class. Left out
of CI, because it fetches a base image.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.dev.matrix import full_marks
from course_kit.dev.steps import CommandStep, StepRunner
from course_kit.grading import exercise
from course_kit.text.console import cannot

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

ENGINES = ("podman", "docker", "buildah")
_IMAGE = "ros2-course-trial"
_LESSON = "notebooks/01_services.ipynb"
_EXECUTE = "jupyter nbconvert --to notebook --execute --allow-errors --stdout --log-level ERROR"
_BUILD_S, _STEP_S = 3600.0, 300.0


@dataclass(frozen=True)
class ContainerEngine:
    """A program that builds and runs containers.

    Attributes:
        name: one of `ENGINES`.
    """

    name: str

    def build(self, options: Sequence[str]) -> list[str]:
        """The command that builds the Containerfile of the working directory."""
        verb = "bud" if self.name == "buildah" else "build"
        return [self.name, verb, *options, "--target", "grader", "-t", _IMAGE, "-f", "Containerfile", "."]

    def run(self, script: str, mounted: Path) -> list[str]:
        """The command that runs a line of sh in a new container, in which a folder is /given, read-only."""
        volume = f"{mounted}:/given:ro"
        if self.name != "buildah":
            return [self.name, "run", "--rm", "--entrypoint", "sh", "-v", volume, _IMAGE, "-c", script]
        run = 'c=$(buildah from --pull-never "$1") && trap \'buildah rm "$c" >/dev/null\' EXIT && '
        run += 'buildah run --user learner -v "$2" "$c" -- sh -c "$3"'
        return ["sh", "-c", run, "sh", _IMAGE, volume, f"cd; export PATH=/opt/course/bin:$PATH; {script}"]


def main(arguments: Sequence[str]) -> int:
    """Run the command; 0 when nothing has failed, 1 when something has, 2 when it cannot be run."""
    options = _parser().parse_args(arguments)
    root = environment.checkout()
    if root is None:
        return cannot("the Containerfile belongs to the course's folder; run this in a clone of it.")
    name = options.engine or next((one for one in ENGINES if shutil.which(one)), None)
    if name is None or shutil.which(name) is None:
        return cannot(f"there is no {name or ' and no '.join(ENGINES)} here. Debian, Ubuntu: sudo apt install podman")
    engine = ContainerEngine(name)
    with tempfile.TemporaryDirectory(prefix="course-container-") as folder, StepRunner() as runner:
        given = Path(folder)
        _put(root, given)
        steps = [CommandStep("image", engine.build(options.build_option), _BUILD_S), *_steps(engine, root, given)]
        results = []
        for step in steps:
            results.append(runner.run(step, root, os.environ))
            if results[0].failed:
                break
    return 1 if any(result.failed for result in results) else 0


def _put(root: Path, given: Path) -> None:
    """Lay what is graded where every user of a container can read it: two students with all solutions."""
    for student in ("ada", "grace"):
        shutil.copytree(root / "solutions", given / "inbox" / student)
    subprocess.run(["chmod", "-R", "a+rX", str(given)], check=True)


def _steps(engine: ContainerEngine, root: Path, given: Path) -> Iterator[CommandStep]:
    yield CommandStep("doctor", engine.run("course-kit doctor", given), _STEP_S)
    for name in exercise.ids(root / "exercises"):
        script = f"course-kit grade {name} /given/inbox/ada/{name}/{name}.py --format json"
        yield CommandStep(name, engine.run(script, given), _STEP_S, full_marks)
    packed = "$(python -c 'import course_kit; print(course_kit.__path__[0])')/course"
    lesson = f'course-kit copy >&2 && {_EXECUTE} "{packed}/{_LESSON}"'
    stored = (root / _LESSON).read_text(encoding="utf-8")
    yield CommandStep("lesson 1", engine.run(lesson, given), _STEP_S, lambda output: differs(stored, output))
    first = exercise.ids(root / "exercises")[0]
    graded = f"course-kit class /given/inbox --exercise {first} --out results && wc -l < results/grades.csv"
    yield CommandStep("class", engine.run(graded, given), _STEP_S)


def differs(stored: str, ran: str) -> str:
    """Which cells of a notebook have ended otherwise than they are stored: with an error, or without that; or nothing.

    Args:
        stored: the notebook of the course.
        ran: the same, executed.
    """
    try:
        pairs = zip(_errors(stored), _errors(ran[ran.index("{") :]), strict=True)
        wrong = [f"cell {number} has {here or 'no error'}" for number, (was, here) in enumerate(pairs) if was != here]
    except ValueError:
        return "the notebook that came back is another one."
    return "; ".join(wrong)


def _errors(notebook: str) -> list[str]:
    """For each cell the class of the exception that it ended with; empty for one that did not."""
    outputs = (cell.get("outputs", ()) for cell in json.loads(notebook)["cells"])
    return [next((one["ename"] for one in each if one["output_type"] == "error"), "") for each in outputs]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="course-kit dev container",
        description="Build the Containerfile, then try doctor, all exercises, lesson 1 and a class in it.",
    )
    parser.add_argument("--engine", choices=ENGINES, help="the first that is installed when left out")
    parser.add_argument(
        "--build-option", action="append", default=[], metavar="OPTION", help="one more for the build; repeatable"
    )
    return parser

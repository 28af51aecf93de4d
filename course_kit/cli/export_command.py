"""`course-kit export`: autograders to upload to a platform, and reports without names."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit.text.sanitize import printable

if TYPE_CHECKING:
    import argparse

_FAILED = 2


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser("export", help="make an autograder for a platform, or reports without names")
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="KIND")
    gradescope = kinds.add_parser("gradescope", help="the autograder zip of an exercise for Gradescope")
    classroom50 = kinds.add_parser("classroom50", help="the autograder folder of an exercise for Classroom 50")
    for kind, what in ((gradescope, "a new .zip file"), (classroom50, "a new folder")):
        kind.add_argument("exercise", help="the exercise's id, as `course-kit list` shows it")
        kind.add_argument("--to", type=Path, required=True, metavar="PATH", help=what)
        kind.add_argument(
            "--seed",
            type=int,
            help="the same values for everybody; an exercise with practice questions needs it for a grade that counts",
        )
    anonymous = kinds.add_parser("anonymous", help="the reports of a class run, by pseudonyms")
    anonymous.add_argument("results", type=Path, help="the folder that `class --out` named")
    anonymous.add_argument("--to", type=Path, required=True, metavar="DIR", help="a new folder")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Export, and say where it is; 2 if that could not be done."""
    from course_kit.grading import GradingError

    try:
        print({"gradescope": _gradescope, "classroom50": _classroom50, "anonymous": _anonymous}[options.kind](options))
    except GradingError as problem:
        return _cannot(str(problem))
    except OSError as problem:
        return _cannot(f"{problem.filename or options.to} could not be written: {problem.strerror or problem}.")
    return 0


def _gradescope(options: argparse.Namespace) -> str:
    from course_kit.authoring import autograders

    path = autograders.gradescope(options.exercise, options.to, options.seed)
    return f"{path}: upload it under Configure Autograder; choose a base image of Ubuntu 22.04 or newer."


def _classroom50(options: argparse.Namespace) -> str:
    from course_kit.authoring import autograders

    path = autograders.classroom50(options.exercise, options.to, options.seed)
    return (
        f"{path}: put what is in it into CLASSROOM/autograders/ASSIGNMENT of your classroom50 repository, but "
        "runtime.json, which is for `gh teacher assignment add --runtime`."
    )


def _anonymous(options: argparse.Namespace) -> str:
    from course_kit.classroom.exports import anonymous
    from course_kit.classroom.stored import gradebook

    return f"{anonymous.write(gradebook(options.results), options.to)}: reports and scores by pseudonyms."


def _cannot(problem: str) -> int:
    print(f"course-kit: {printable(problem)}", file=sys.stderr)
    return _FAILED

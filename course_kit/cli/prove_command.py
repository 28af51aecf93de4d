"""`course-kit prove`: what would the grader of an exercise let through?"""

from __future__ import annotations

import argparse
from typing import Any

from course_kit.text.console import cannot, tell

_INTERRUPTED = 130


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser(
        "prove",
        help="find out what the grader of an exercise lets through",
        description="Makes every small mistake in the solution, grades each, and prints those that get full marks.",
        epilog="Exit code: 0 when nothing was found, 1 when something was, 2 when it could not be tried, 130 when it "
        "was stopped. Mistakes that are none are declared with the reason in equivalent.toml: see "
        "course_kit/authoring/AUTHORING.md.",
    )
    parser.add_argument("exercise", metavar="EXERCISE")
    parser.add_argument("--quick", action="store_true", help="a sample of the mistakes, with one seed")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="what the checks draw from (1)")
    parser.add_argument(
        "--workers", type=_count, default=0, metavar="N", help="gradings at a time (as fit this machine)"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Prove; 0 when nothing was found, 1 when something was, 2 when it could not be tried, 130 when it was stopped."""
    from course_kit.authoring.prove import proving
    from course_kit.grading import GradingError, exercise

    try:
        task = exercise.load(options.exercise)
        proof = proving.prove(task, quick=options.quick, seed=options.seed, workers=options.workers)
    except GradingError as problem:
        return cannot(problem)
    except KeyboardInterrupt:
        tell("Stopped.")
        return _INTERRUPTED
    print("\n".join(proving.describe(proof, quick=options.quick)))
    return 0 if proof.holds else 1


def _count(text: str) -> int:
    number = int(text)
    if number < 0:
        raise argparse.ArgumentTypeError("it has to be a number from 0 up")
    return number

"""`course-kit prove`: what would the grader of an exercise let through?"""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING, Any

from course_kit.text.console import cannot, tell

if TYPE_CHECKING:
    from course_kit.authoring.prove.outcome import GraderProof
    from course_kit.authoring.prove.table import ProveProgress

_INTERRUPTED = 130


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser(
        "prove",
        help="find out what the grader of an exercise lets through",
        description="Makes every small mistake in the solution, grades each, and prints those that get full marks. "
        "Grades right programs made from the solution, too, again on a busy machine, and names what is rejected or "
        "differs from one time to the next.",
        epilog="Exit code: 0 when nothing was found, 1 when something was, 2 when it could not be tried, 130 when it "
        "was stopped. Mistakes that are none are declared with the reason in equivalent.toml: see "
        "course_kit/authoring/AUTHORING.md.",
    )
    parser.add_argument("exercise", metavar="EXERCISE")
    parser.add_argument("--quick", action="store_true", help="under a minute: a sample of the mistakes, no repeats")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="what the checks draw from (1)")
    parser.add_argument(
        "--seeds", type=_count, metavar="N", help="other seeds for a mistake that gets full marks (2; 40 for answers)"
    )
    parser.add_argument(
        "--repeat", type=_count, default=2, metavar="N", help="gradings of right programs under load (2)"
    )
    parser.add_argument(
        "--workers", type=_count, default=0, metavar="N", help="gradings at a time (as fit this machine)"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Prove; 0 when nothing was found, 1 when something was, 2 when it could not be tried, 130 when it was stopped."""
    from course_kit.authoring.prove import table
    from course_kit.grading import GradingError

    progress = table.ProveProgress(sys.stderr)
    try:
        proof = _proof(options, progress)
    except GradingError as problem:
        return cannot(problem)
    except KeyboardInterrupt:
        sys.stderr.write("\n" if sys.stderr.isatty() else "")
        tell(f"Stopped after {progress.graded} gradings.")
        return _INTERRUPTED
    print(table.as_text(proof))
    return 0 if proof.holds else 1


def _proof(options: argparse.Namespace, progress: ProveProgress) -> GraderProof:
    from course_kit.authoring.prove import places, proving
    from course_kit.grading import exercise

    task = exercise.load(options.exercise)
    how = proving.HowToProve(
        quick=options.quick,
        seed=options.seed,
        repeat=options.repeat,
        workers=options.workers,
        more_seeds=options.seeds,
    )
    return proving.prove(task, places.of(task), how, progress)


def _count(text: str) -> int:
    number = int(text)
    if number < 0:
        raise argparse.ArgumentTypeError("it has to be a number from 0 up")
    return number

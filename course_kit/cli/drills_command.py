"""`course-kit drills`: lists the drills, or begins one."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from course_kit.text.console import cannot, tell

if TYPE_CHECKING:
    import argparse


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser("drills", help="list the drills, small repairs for practice; or begin one")
    parser.add_argument("drill", nargs="?", help="the drill's id, e.g. empty_dashboard")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """List the drills, or tell how to begin the one that is named; 2 when that cannot be done."""
    from course_kit.grading import GradingError
    from course_kit.learner import drills

    try:
        if options.drill is not None:
            print(drills.begin(options.drill))
            return 0
        text, told = drills.listed(sys.stdout.encoding)
    except GradingError as problem:
        return cannot(problem)
    print(text)
    for sentence in told:
        tell(sentence)
    return 0

"""`course-kit seeds`: writes the list for `class --seeds`, a seed for each student of a roster."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import argparse

FAILED = 2


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser(
        "seeds",
        help="draw a seed for each student of a roster, for class --seeds",
        epilog="Students who have a seed in FILE already keep it, so that the command can be run again when somebody "
        "joins the class.",
    )
    parser.add_argument("roster", type=Path, help="the class list, as for class --roster")
    parser.add_argument("--layout", default="", help="of the submissions, as for class: decides how students are named")
    parser.add_argument("--out", type=Path, metavar="FILE", help="the list; printed when left out")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Draw the seeds; returns 0, or 2 when that could not be done."""
    from course_kit.classroom.exports.texts import csv_text
    from course_kit.classroom.rules import seeds
    from course_kit.environment import write_atomically
    from course_kit.grading import GradingError
    from course_kit.text.sanitize import printable

    try:
        before = seeds.read(options.out) if options.out and options.out.exists() else None
        drawn = seeds.draw(seeds.students_of(options.roster, options.layout), before)
        text = csv_text([seeds.COLUMNS, *((student, seed) for student, seed in drawn.items())])
        if options.out:
            write_atomically(options.out, text)
        else:
            sys.stdout.write(text)
    except GradingError as problem:
        print(f"course-kit: {printable(str(problem))}", file=sys.stderr)
        return FAILED
    except OSError as problem:
        print(f"course-kit: {options.out} could not be written: {problem.strerror}.", file=sys.stderr)
        return FAILED
    return 0

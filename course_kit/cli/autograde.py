"""`course-kit grade --format gradescope` and `classroom50`: one result in the words of a platform's autograder."""

from __future__ import annotations

import os
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.cli import streams

if TYPE_CHECKING:
    import argparse

FORMATS = ("gradescope", "classroom50")


def run(options: argparse.Namespace) -> int:
    """Grade a file or folder, and print the result or write it to a file."""
    from course_kit.classroom import autograder
    from course_kit.classroom.exports import autograder_results
    from course_kit.classroom.exports.texts import json_text
    from course_kit.grading import GradingError

    if options.path is None or options.attach or options.exec_command is not None:
        raise GradingError(f"--format {options.format} grades what was handed in. Name the file or folder.")
    if options.format == "classroom50":  # before the grading: it would be for nothing
        autograder_results.require_runner(os.environ)
    try:
        record = autograder.grade(
            options.exercise, Path(options.path), seed=options.seed, require_isolation=options.require_isolation
        )
        if options.format == "gradescope":
            text = json_text(autograder_results.gradescope_result(record))
        else:
            text = json_text(autograder_results.classroom50_result(record, os.environ, datetime.now(timezone.utc)))
        if options.to is None:
            streams.print_json(text)
        else:
            environment.write_atomically(options.to, f"{text}\n")
    except OSError as problem:
        where = f" ({problem.filename})" if problem.filename else ""
        raise GradingError(f"The result could not be written: {problem.strerror or problem}{where}.") from problem
    return 0


def require_no_target(options: argparse.Namespace) -> None:
    """See that nobody waits for a file that other formats do not write."""
    from course_kit.grading import GradingError

    if options.to is not None:
        raise GradingError(f"--to is for --format {' and '.join(FORMATS)}. Redirect the output instead.")

"""The entry point of the `course-kit` command.

It first takes the working directory off the path of modules: instructors call the command where submissions lie, and
a `random.py` among them must not become part of the grader.
"""

from __future__ import annotations

import os
import sys


def main() -> int:
    """Run the command line; returns its exit code."""
    _leave_out_the_working_directory()
    from course_kit.cli.main import main as command_line

    return command_line()


def _leave_out_the_working_directory() -> None:
    try:
        here = os.path.realpath(os.getcwd())  # noqa: PTH109 - nothing but what is loaded already may be imported here
    except OSError:  # it was removed
        return
    kit = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))  # noqa: PTH120
    if here != kit:
        sys.path[:] = [entry for entry in sys.path if entry and os.path.realpath(entry) != here]


if __name__ == "__main__":
    sys.exit(main())

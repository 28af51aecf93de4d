"""`%hint`: the next hint of an exercise, in a notebook."""

from __future__ import annotations

import shlex
import sys

from course_kit.grading.errors import GradingError
from course_kit.integrations.grade_magics import the_exercises

USAGE = "Use it as %hint EXERCISE. --again repeats those you have already seen."


def hint_line(line: str) -> None:
    """Show one more hint for what failed last: `%hint EXERCISE`; `--again` repeats those given so far."""
    from course_kit.learner import hints

    try:
        words = shlex.split(line)
    except ValueError:
        words = []
    again = "--again" in words
    names = [word for word in words if word != "--again"]
    if len(names) != 1 or names[0].startswith("-"):
        sys.stderr.write(f"{USAGE} {the_exercises()}\n")
        return
    try:
        text, trouble = hints.hint(names[0], "%hint", again=again)
    except GradingError as problem:
        sys.stderr.write(f"{problem}\n")
        return
    sys.stdout.write(text)
    if trouble:
        sys.stderr.write(f"{trouble}\n")

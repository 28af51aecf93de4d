"""What commands over a class have in common: how they end, what they say, and how Ctrl-C reaches them."""

from __future__ import annotations

import shlex
import signal
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterator, Sequence

FAILED, INTERRUPTED = 2, 130
_MOST_NAMED = 20  # students in a sentence; the class page has them all


def told(work: Callable[[argparse.Namespace], int], options: argparse.Namespace) -> int:
    """Do it, and say in a sentence what stopped it."""
    from course_kit.classroom.executors import SchedulerLostError
    from course_kit.grading import GradingError

    try:
        return work(options)
    except KeyboardInterrupt:  # before the first grading; what had begun ends by itself, and says how to go on
        say("\ncourse-kit: stopped. Nothing was graded; run the same command again.")
        return INTERRUPTED
    except SchedulerLostError as problem:
        say(
            f"\ncourse-kit: {problem} The results so far are safe. Start a scheduler and its workers, then run:\n"
            f"  {command_to_continue(options)}"
        )
    except GradingError as problem:
        say(f"course-kit: {problem}")
    except OSError as problem:
        where = f" ({problem.filename})" if problem.filename else ""
        say(
            f"\ncourse-kit: a result could not be written: {problem.strerror or problem}{where}. The results before it "
            f"are safe. Fix this, then run:\n  {command_to_continue(options)}"
        )
    return FAILED


def command_to_continue(options: argparse.Namespace) -> str:
    """The command that goes on where this one has ended, as one would type it."""
    more = [] if getattr(options, "resume", True) else ["--resume"]
    return shlex.join([environment.command(), *options.arguments, *more])


def say(text: str) -> None:
    """Tell a person something in which names of strangers may stand."""
    from course_kit.text.sanitize import printable

    print(printable(text), file=sys.stderr)


def many(of_what: Sequence[str], name: str) -> str:
    """`1 student`, `2 students`."""
    return f"{len(of_what)} {name}{'s' * (len(of_what) != 1)}"


def some(parts: Sequence[str], between: str = ", ") -> str:
    """The first ones, and how many more there are."""
    more = len(parts) - _MOST_NAMED
    return between.join(parts[:_MOST_NAMED]) + (f"{between}and {more} more" if more > 0 else "")


@contextmanager
def interrupts() -> Iterator[Callable[[], int]]:
    """Count Ctrl-C instead of being cut off by it in the middle of a result."""
    pressed: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _frame: pressed.append(number))
    try:
        yield lambda: len(pressed)
    finally:
        signal.signal(signal.SIGINT, before)

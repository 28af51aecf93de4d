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
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from course_kit.classroom.executors import Executor
    from course_kit.classroom.grading_loop import RunProgress
    from course_kit.classroom.intake.collecting import Intake
    from course_kit.classroom.intake.roster import Roster
    from course_kit.classroom.intake.roster_matching import Fit
    from course_kit.classroom.records import Gradebook
    from course_kit.classroom.regrade import GradeChange
    from course_kit.classroom.run import ClassRun
    from course_kit.grading.exercise import Exercise

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


def say_of_intake(found: Intake, exercises: Iterable[Exercise]) -> None:
    """Tell what somebody should look at."""
    for sentence in _sentences(found, exercises):
        say(sentence)


def _sentences(found: Intake, exercises: Iterable[Exercise]) -> Iterator[str]:
    called = {entry.student: entry.called for entry in (*found.entries, *found.others)}
    doubtful = [f"{entry.called}, {entry.exercise} ({entry.worry})" for entry in found.entries if entry.worry]
    if doubtful:
        yield f"Look at the choice of file in intake.csv: {some(doubtful)}."
    if found.roster is not None:
        yield from _of_roster(found.roster, called)
        yield from _of_canvas(found.roster.roster, exercises)


def _of_roster(fit: Fit, called: Mapping[str, str]) -> Iterator[str]:
    read_as = ", ".join(f"'{header}' as {kind}" for header, kind in fit.roster.read_as)
    total = len(fit.roster.people)
    yield f"{fit.roster.called}: read {read_as}; {fit.matched} of {total} on it handed something in."
    if fit.absent:
        yield f"Not handed in: {some([one.name or one.student for one in fit.absent])}."
    if fit.unknown:
        unknown = [f"{called.get(who, who)} ({why})" for who, why in fit.unknown]
        yield f"Not matched with {fit.roster.called}: {some(unknown)}."


def _of_canvas(roster: Roster, exercises: Iterable[Exercise]) -> Iterator[str]:
    """Which exercises of Canvas's gradebook have no assignment: its import would make a new one without asking."""
    from course_kit.classroom.exports.tables import CANVAS, canvas_assignment

    named = roster.canvas_assignments
    absent = [one.id for one in exercises if named and not canvas_assignment(one, named)]
    if absent:
        yield (
            f"No assignment in {roster.called}, or more than one, is called like {', '.join(absent)}, so {CANVAS} has "
            "a new column for it. To fill an existing one, put the exercise's name into its title in Canvas and export "
            "the gradebook again."
        )


def grade_again(
    options: argparse.Namespace,
    class_run: ClassRun,
    progress: RunProgress,
    start: Callable[[], Executor],
    stops: Callable[[], int],
) -> Gradebook | None:
    """Grade again what `--again` names; returns the new gradebook, None where nothing was written."""
    from course_kit.classroom.regrade import Regrade

    regrade = Regrade(class_run, options.out, options.again, progress)
    changes = regrade.grade(start, stops)
    if not regrade.complete:
        say("course-kit: stopped. No result was changed. The same command goes on.")
        return None
    book = regrade.write() if _is_wanted(changes, options) else None
    if regrade.failed:
        whose = [f"{record.entry.called}, {record.entry.exercise}" for record in regrade.failed]
        say(
            f"course-kit: the grader failed for {many(whose, 'submission')}: "
            f"{some(whose, '; ')}. Their results stay as they are. Run the same command again."
        )
    return book


def _is_wanted(changes: Sequence[GradeChange], options: argparse.Namespace) -> bool:
    """Show what would change, and ask."""
    from course_kit.classroom.regrade import TABLE, table
    from course_kit.text.sanitize import printable

    for line in table(changes) if changes else ["No result changes."]:
        print(printable(line))
    print(f"The same as a file: {options.out / TABLE}", flush=True)
    if options.write or not changes:
        return bool(options.write)
    if not sys.stdin.isatty():
        say("Nothing was written. To write it, run the same command with --write; nothing is graded twice.")
        return False
    wanted = many([change.row[0] for change in changes], "result")
    print(f"Write {wanted}? [y/N] ", end="", file=sys.stderr, flush=True)
    if sys.stdin.readline().strip().lower() in ("y", "yes"):
        return True
    say("Nothing was written.")
    return False

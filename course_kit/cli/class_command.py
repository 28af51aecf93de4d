"""`course-kit class`: grades a whole class and writes everything that an instructor and a learning platform need."""

from __future__ import annotations

import argparse
import csv
import signal
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit.cli import intake_words

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from course_kit.classroom.executors import Executor
    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.run import Plan

FAILED, INTERRUPTED = 2, 130
_MOST_NAMED = 20  # students in a sentence; the class page has them all


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser(
        "class",
        help="grade a whole class: a folder or zip of submissions",
        epilog="After Ctrl-C, a crash or a full disk, run the same command with --resume. Exit code: 0 when everything "
        "handed in has its grade; 2 when it could not be done, no submission was found, a student was dropped or a "
        "submission could not be graded through no fault of its student; 130 when it was stopped.",
    )
    parser.add_argument(
        "submissions",
        type=Path,
        nargs="+",
        help="a folder or zip, as your learning platform gives it; several, or a folder of zips, of one class",
    )
    parser.add_argument(
        "--exercise", action="append", required=True, metavar="ID", help="an exercise that was set; give it repeatedly"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="the folder for all results")
    parser.add_argument("--resume", action="store_true", help="continue an earlier run into DIR")
    parser.add_argument(
        "--dry-run", action="store_true", help="show which file would be graded for whom and why, and grade nothing"
    )
    parser.add_argument(
        "--roster",
        type=Path,
        metavar="CSV",
        help="the class list, as Canvas, Moodle or nbgrader export it, or any other",
    )
    parser.add_argument(
        "--layout", default="auto", help="canvas, moodle, gradescope, nbgrader, github, folders or files"
    )
    parser.add_argument("--seed", type=int, help="draw the same random values as an earlier run")
    parser.add_argument("--seeds", type=Path, metavar="CSV", help="two columns, student and seed, as for exercise 4")
    parser.add_argument("--require-isolation", action="store_true", help="refuse to grade without full isolation")
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--workers",
        type=_positive,
        metavar="N",
        help="number of gradings at the same time on this machine, more while they only wait",
    )
    where.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler, such as tcp://10.0.0.1:8786")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Grade the class.

    Returns:
        0 when everything handed in has its grade; 2 when it could not be done, no submission was found, a student was
        dropped or the grader itself failed for a submission; 130 when it was stopped.
    """
    from course_kit.grading import GradingError

    try:
        return _run(options)
    except GradingError as problem:
        _say(f"course-kit: {problem}")
    except OSError as problem:
        where = f" ({problem.filename})" if problem.filename else ""
        _say(
            f"\ncourse-kit: a result could not be written: {problem.strerror or problem}{where}. The results before it "
            "are safe. Fix this, then run the same command with --resume."
        )
    return FAILED


def _say(text: str) -> None:
    """Tell a person something in which names of strangers may stand."""
    from course_kit.text.sanitize import printable

    print(printable(text), file=sys.stderr)


def _run(options: argparse.Namespace) -> int:
    from course_kit.classroom import roster
    from course_kit.classroom.progress import RunProgress
    from course_kit.classroom.run import ClassRun, Plan
    from course_kit.grading import GradingError, exercise, isolation_status, needs

    chosen = {one: exercise.load(one) for one in options.exercise}
    if options.out.exists() and not options.out.is_dir():
        raise GradingError(f"{options.out} is a file. --out has to name a folder for the results.")
    if not options.scheduler and not options.dry_run:
        for one in chosen.values():
            needs.require(one.limits)
    if options.require_isolation:
        isolation_status().require()
    plan = Plan(
        source=options.submissions[0],
        more=tuple(options.submissions[1:]),
        roster=roster.read(options.roster) if options.roster else None,
        out=options.out,
        exercises=tuple(sorted(chosen.values(), key=lambda one: one.order)),
        seed=options.seed,
        seeds=_read_seeds(options.seeds) if options.seeds else {},
        layout=options.layout,
        resume=options.resume,
    )
    if options.dry_run:
        return _dry_run(plan)
    tally = RunProgress(sys.stderr)
    with _interrupts() as stops:
        grading = ClassRun(plan, tally, stops)
        book = grading.grade(lambda: _executor(options, [one.grader for one in chosen.values()]))
    tally.end()
    intake_words.say(grading.intake, _say)
    return _finish(book, options.out)


def _dry_run(plan: Plan) -> int:
    """Print the table of what would be graded."""
    from course_kit.classroom import dry_run, table
    from course_kit.classroom.preconditions import require_submissions
    from course_kit.text.sanitize import printable

    with _interrupts() as stops:
        found = dry_run.look(plan, lambda: stops() > 0)
    print(printable(table.as_text(found)))
    intake_words.say(found, _say)
    print(plan.out / table.FILE)
    require_submissions(found, plan.sources, plan.exercises)
    if found.dropped:
        _say(f"course-kit: {_left_out(found.dropped)}")
    return FAILED if found.dropped else 0


def _finish(book: Gradebook, out: Path) -> int:
    from course_kit.classroom import exports
    from course_kit.grading import advice_for_root

    if advice := advice_for_root():
        print(f"course-kit: {advice}", file=sys.stderr)
    page = exports.write_all(book, out)
    if book.left:
        what = (
            "1 file was not recognised as a submission; it is"
            if len(book.left) == 1
            else f"{len(book.left)} files were not recognised as submissions; they are"
        )
        _say(f"{what} listed in {page.name}.")
    if book.odd:
        odd = [f"{student} ({reason})" for student, reason in book.odd]
        _say(f"Graded as separate students, because their names do not fit the layout '{book.layout}': {_some(odd)}.")
    print(page)
    worries = list(_worries(book))
    for worry in worries:
        _say(f"course-kit: {worry}")
    if not book.complete:
        _say("course-kit: stopped. Run the same command with --resume to continue.")
        return INTERRUPTED
    return FAILED if worries else 0


def _worries(book: Gradebook) -> Iterator[str]:
    """What is missing from the grades, a sentence each."""
    if book.dropped:
        yield _left_out(book.dropped)
    if failed := book.not_graded:
        whose = [f"{record.entry.student}, {record.entry.exercise}" for record in failed]
        yield (
            f"{_many(whose, 'submission')} could not be graded, through no fault of the student: {_some(whose, '; ')}. "
            "Run the same command with --resume."
        )


def _left_out(dropped: Sequence[tuple[str, str]]) -> str:
    reasons = [f"{student} ({reason})" for student, reason in dropped]
    return f"{_many(reasons, 'student')} handed in something that was not graded: {_some(reasons)}."


def _many(of_what: list[str], name: str) -> str:
    return f"{len(of_what)} {name}{'s' * (len(of_what) != 1)}"


def _some(parts: list[str], between: str = ", ") -> str:
    more = len(parts) - _MOST_NAMED
    return between.join(parts[:_MOST_NAMED]) + (f"{between}and {more} more" if more > 0 else "")


def _executor(options: argparse.Namespace, graders: list[str]) -> Executor:
    from course_kit.classroom import executors, exports

    del exports  # needed at the end: imported now it costs no time, the workers start

    if options.scheduler:
        return executors.Cluster(options.scheduler)
    return executors.Local(options.workers, graders)


def _read_seeds(path: Path) -> dict[str, int]:
    """Students' own seeds.

    Raises:
        GradingError: the file is missing or holds something else.
    """
    from course_kit.grading import GradingError
    from course_kit.text.sanitize import one_line

    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = [row for row in csv.reader(file) if row]
        body = rows[1:] if rows and not rows[0][-1].strip().lstrip("-").isdigit() else rows
        return {one_line(student): int(seed) for student, seed in body}
    except OSError as problem:
        raise GradingError(f"{path} could not be read: {problem.strerror}.") from problem
    except (ValueError, csv.Error) as problem:
        raise GradingError(
            f"{path} is not a list of students and seeds (two columns in each line): {problem}."
        ) from problem


@contextmanager
def _interrupts() -> Iterator[Callable[[], int]]:
    """Count Ctrl-C instead of being cut off by it in the middle of a result."""
    pressed: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _frame: pressed.append(number))
    try:
        yield lambda: len(pressed)
    finally:
        signal.signal(signal.SIGINT, before)


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError("at least 1")
    return number

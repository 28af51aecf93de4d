"""`course-kit class`: grades a whole class and writes everything that an instructor and a learning platform need."""

from __future__ import annotations

import argparse
import csv
import importlib
import signal
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from course_kit.grading.classroom.executors import Executor
    from course_kit.grading.classroom.gradebook import Gradebook

INTERRUPTED = 130


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser(
        "class",
        help="grade a whole class: a folder or zip of submissions",
        epilog="After Ctrl-C, a crash or a full disk run the same command with --resume.",
    )
    parser.add_argument("submissions", type=Path, help="a folder or zip, as your learning platform gives it")
    parser.add_argument(
        "--exercise", action="append", required=True, metavar="ID", help="an exercise that was set; give it repeatedly"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="the folder for all results")
    parser.add_argument("--resume", action="store_true", help="go on where an earlier run into DIR has ended")
    parser.add_argument("--layout", default="auto", help="canvas, moodle, nbgrader, github, folders or files")
    parser.add_argument("--seed", type=int, help="draw the same random values as an earlier run")
    parser.add_argument("--seeds", type=Path, metavar="CSV", help="two columns, student and seed, as for exercise 4")
    parser.add_argument("--require-isolation", action="store_true", help="refuse to grade without full isolation")
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        "--workers", type=_positive, metavar="N", help="gradings side by side here, more while they only wait"
    )
    where.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler, such as tcp://10.0.0.1:8786")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Grade the class.

    Returns:
        0 when every submission has its grade, 1 when some met an error of the grader, 2 when it could not be done,
        130 when it was stopped.
    """
    from course_kit.grading import GradingError

    try:
        return _run(options)
    except GradingError as problem:
        print(f"course-kit: {problem}", file=sys.stderr)
    except OSError as problem:
        where = f" ({problem.filename})" if problem.filename else ""
        print(
            f"\ncourse-kit: a result could not be written: {problem.strerror}{where}. The results before it are safe: "
            "put that right and run the same command with --resume.",
            file=sys.stderr,
        )
    return 2


def _run(options: argparse.Namespace) -> int:
    from course_kit.grading import GradingError, advice_for_root, exercise, isolation_status
    from course_kit.grading.classroom.run import ClassRun, Plan
    from course_kit.grading.classroom.watching import Tally

    chosen = {one: exercise.load(one) for one in options.exercise}
    if options.out.exists() and not options.out.is_dir():
        raise GradingError(f"{options.out} is a file. --out names the folder for the results.")
    if options.require_isolation:
        isolation_status().require()
    if advice := advice_for_root():
        print(f"course-kit: {advice}", file=sys.stderr)
    plan = Plan(
        source=options.submissions,
        out=options.out,
        exercises=tuple(sorted(chosen.values(), key=lambda one: one.order)),
        seed=options.seed,
        seeds=_read_seeds(options.seeds) if options.seeds else {},
        layout=options.layout,
        resume=options.resume,
    )
    tally = Tally(sys.stderr)
    with _interrupts() as stops:
        grading = ClassRun(plan, tally, stops)
        book = grading.grade(lambda: _executor(options))
    tally.end()
    return _finish(book, options.out)


def _finish(book: Gradebook, out: Path) -> int:
    from course_kit.grading import exports

    page = exports.write_all(book, out)
    if book.left:
        what = (
            "1 file is no submission; it is"
            if len(book.left) == 1
            else f"{len(book.left)} files are no submissions; they are"
        )
        print(f"{what} listed in {page.name}.", file=sys.stderr)
    print(page)
    if not book.complete:
        print("course-kit: stopped. Run the same command with --resume to go on.", file=sys.stderr)
        return INTERRUPTED
    return 1 if book.tally()["error"] else 0


def _executor(options: argparse.Namespace) -> Executor:
    from course_kit.grading.classroom import executors

    if options.scheduler:
        return executors.Cluster(options.scheduler)
    started = executors.Local(options.workers, options.exercise)
    importlib.import_module("course_kit.grading.exports")  # needed at the end: now it costs no time, the workers start
    return started


def _read_seeds(path: Path) -> dict[str, int]:
    """Students' own seeds.

    Raises:
        GradingError: the file is missing or holds something else.
    """
    from course_kit.grading import GradingError

    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = [row for row in csv.reader(file) if row]
        body = rows[1:] if rows and not rows[0][-1].strip().lstrip("-").isdigit() else rows
        return {student.strip(): int(seed) for student, seed in body}
    except OSError as problem:
        raise GradingError(f"{path} could not be read: {problem.strerror}.") from problem
    except (ValueError, csv.Error) as problem:
        raise GradingError(f"{path} is no list of students and seeds, two columns each line: {problem}.") from problem


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

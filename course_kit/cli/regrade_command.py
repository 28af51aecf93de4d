"""`course-kit regrade`: grades results of a class again, shows who changes from what to what, then writes it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit.cli import class_command
from course_kit.cli.class_words import FAILED, INTERRUPTED, interrupts, many, say, some, told

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

    from course_kit.classroom.regrade import GradeChange, Regrade


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser(
        "regrade",
        help="grade results of a class again, for example when a grader has been fixed",
        epilog="`course-kit class regrade DIR` is the same. Nothing is written before you say so, at the question or "
        "by --write; old results are kept in DIR/superseded. Exit code: 0 when it went well; 2 when something could "
        "not be graded again; 130 when it was stopped.",
    )
    parser.add_argument("out", type=Path, metavar="DIR", help="the folder of the results, --out of course-kit class")
    parser.add_argument("--exercise", action="append", default=[], metavar="ID", help="only this one; repeatable")
    parser.add_argument(
        "--check", action="append", default=[], metavar="ID", help="only results that have this check; repeatable"
    )
    parser.add_argument("--student", action="append", default=[], metavar="NAME", help="only this one; repeatable")
    parser.add_argument("--write", action="store_true", help="write the changes without asking")
    class_command.add_where(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Grade again.

    Returns:
        0 when it went well, whether something was written or not; 2 when something could not be graded again; 130
        when it was stopped.
    """
    return told(_run, options)


def _run(options: argparse.Namespace) -> int:
    from course_kit.classroom import exports, run_lock
    from course_kit.classroom.progress import RunProgress
    from course_kit.classroom.regrade import Regrade, Selection
    from course_kit.classroom.run import ClassRun, hidden_folders, plan_of

    plan = plan_of(options.out)
    class_command.require_machine(options, plan.exercises)
    progress = RunProgress(sys.stderr)
    with run_lock.hold(options.out), interrupts() as stops:
        chosen = Selection(options.exercise, options.check, options.student)
        regrade = Regrade(ClassRun(plan, progress, stops), options.out, chosen, progress)
        changes = regrade.grade(lambda: class_command.executor(options, plan.exercises), stops, hidden_folders(plan))
        progress.end()
        if not regrade.complete:
            say("course-kit: stopped. Nothing was changed. The same command goes on.")
            return INTERRUPTED
        if _is_wanted(changes, options):
            print(exports.write_all(regrade.write(), options.out))
        return _worries(regrade)


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


def _worries(regrade: Regrade) -> int:
    if regrade.not_at_hand:
        say(
            f"course-kit: {many(regrade.not_at_hand, 'submission')} changed after the grading, or "
            f"cannot be read: {some(regrade.not_at_hand, '; ')}. Their results stay as they are. Run "
            "course-kit class with --resume to grade them as they are now."
        )
    if regrade.failed:
        whose = [f"{record.entry.student}, {record.entry.exercise}" for record in regrade.failed]
        say(
            f"course-kit: the grader failed for {many(whose, 'submission')}: "
            f"{some(whose, '; ')}. Their results stay as they are. Run the same command again."
        )
    return FAILED if regrade.not_at_hand or regrade.failed else 0

"""`course-kit class --resume --again EXERCISE`: shows who changes from what to what, then writes it."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from course_kit.cli.class_words import many, say, some

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Sequence

    from course_kit.classroom.executors import Executor
    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.grading_loop import Watcher
    from course_kit.classroom.regrade import GradeChange
    from course_kit.classroom.run import ClassRun


def run(
    options: argparse.Namespace,
    class_run: ClassRun,
    watcher: Watcher,
    start: Callable[[], Executor],
    stops: Callable[[], int],
) -> Gradebook | None:
    """Grade again what `--again` names; returns the new gradebook, None where nothing was written."""
    from course_kit.classroom.regrade import Regrade

    regrade = Regrade(class_run, options.out, options.again, watcher)
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

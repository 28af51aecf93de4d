"""`course-kit watch`: grades a file each time it is saved, and prints the verdict in a few lines.

The file is asked for its state five times a second with the standard library. The `watchfiles` library would not do
better here: one file, editors that replace it on saving, and network folders that send no news.
"""

from __future__ import annotations

import threading
import time
from contextlib import ExitStack
from typing import TYPE_CHECKING

from course_kit.grading import Worker, advice_for_root, exercise, grade
from course_kit.grading.errors import GradingError
from course_kit.learner import progress, workspace
from course_kit.text.console import in_points, tell, wrapped

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from typing_extensions import Self

    from course_kit.grading import CheckReport, Report

_POLL_S = 0.2
_GONE_POLLS = 10  # editors that write beside the file and rename need a moment; longer than this is worth a word
_NOT_GRADED = frozenset({"unreadable", "error"})


def watch(exercise_id: str, path: Path | None = None) -> int:
    """Grade at once and after each save, until Ctrl-C, which is the way to end it: 0.

    Raises:
        GradingError: there is no such exercise or no such file, or the grader could not start twice in a row.
    """
    task = exercise.load(exercise_id)
    path = workspace.own_file(task, "watch") if path is None else path
    if path.is_dir():
        raise GradingError(f"{path} is a folder. Name the .py or .ipynb file in it.")
    if not path.is_file():
        raise GradingError(f"There is no file {path}.")
    best: Report | None = None
    try:
        with _Grader(task.id, path) as grader:
            if advice := advice_for_root():
                print("\n".join(wrapped(f"{advice[:1].upper()}{advice[1:]}")))
            print(f"Watching {path}: it is graded each time you save it. Ctrl-C ends.", flush=True)
            before: Report | None = None
            for _ in saves(path, threading.Event()):
                report = grader.grade()
                print(card(report, before), flush=True)
                before = report
                best = report if best is None or report.score > best.score else best
    except KeyboardInterrupt:
        print("\nNo longer watching." + ("" if best is None else _best(best)))
    return 0


class _Grader:
    """A warm worker for one file, replaced when it fails."""

    def __init__(self, exercise_id: str, path: Path) -> None:
        self._exercise, self._path = exercise_id, path
        self._open = ExitStack()
        self._worker = self._open.enter_context(Worker())

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *problem: object) -> None:
        self._open.close()

    def grade(self) -> Report:
        """Grade and record.

        Raises:
            GradingError: a second worker failed, too.
        """
        try:
            report = grade(self._exercise, self._path, worker=self._worker)
        except GradingError:  # killed for want of memory, perhaps; a new one deserves its chance
            self._open.close()
            self._worker = self._open.enter_context(Worker())
            report = grade(self._exercise, self._path, worker=self._worker)
        tell(progress.record(report))
        return report


def saves(path: Path, stop: threading.Event, poll_s: float = _POLL_S) -> Iterator[None]:
    """Yield once at the beginning and once after each save, when the file has come to rest; ends when `stop` is set.

    Args:
        path: the file.
        stop: ends it.
        poll_s: how often the file is looked at, in seconds.
    """
    seen = before = None
    gone = 0
    while not stop.wait(poll_s):
        now = _signature(path)
        gone = gone + 1 if now is None else 0
        if gone == _GONE_POLLS:
            print(f"{path} is gone. Waiting for it to come back.", flush=True)
        if now is not None and now == before and now != seen:
            seen = now
            yield
        before = now


def _signature(path: Path) -> tuple[int, int, int] | None:
    """What differs after each save: the time, the size, or with editors that rename the file itself."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size, status.st_ino


def card(report: Report, before: Report | None) -> str:
    """The verdict in a few lines of at most 80 columns: what changed, what to fix first, and what else is wrong."""
    lines = ["", f"{time.strftime('%H:%M:%S')}  {_verdict(report)}{_difference(report, before)}"]
    failed = [check for check in report.checks if check.status in ("failed", "error")]
    for number, check in enumerate(failed):
        lines += wrapped(f"FAIL  {check.title}", "  ", " " * 8)
        if number == 0:
            lines += _first(check)
    if report.problem:
        lines += wrapped(report.problem, "  ", "  ")
    lines += _others(report)
    return "\n".join(lines)


def _verdict(report: Report) -> str:
    if report.status in _NOT_GRADED:
        return "Not graded."
    return f"{report.verdict} ({report.duration_s:.1f} s)"


def _best(report: Report) -> str:
    if report.practice:
        return f" {report.verdict.capitalize()}."
    return f" Best score: {in_points(report.score)}."


def _difference(report: Report, before: Report | None) -> str:
    if (
        report.practice
        or before is None
        or report.score == before.score
        or {report.status, before.status} & _NOT_GRADED
    ):
        return ""
    return f", {report.score - before.score:+g} since the last save"


def _first(check: CheckReport) -> list[str]:
    parts = (
        ("sent", check.sent),
        ("expected", check.expected),
        ("got", check.got),
        ("why", check.message),
        ("hint", check.hint or ""),
    )
    return [line for name, text in parts if text for line in wrapped(f"{name:<9} {text}", " " * 8, " " * 18)]


def _others(report: Report) -> list[str]:
    lines = []
    skipped = sum(check.status == "skipped" for check in report.checks)
    if skipped:
        lines.append(f"  skip  {skipped} that need these to pass first")
    passed = sum(check.status == "passed" for check in report.checks)
    if passed:
        lines.append(f"  PASS  {passed} of {len(report.checks)} checks")
    return lines

"""`course-kit watch`: grades a file each time it is saved, and prints the verdict in a few lines."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

from course_kit.grading import Worker, advice_for_root, grade
from course_kit.grading.errors import GradingError
from course_kit.grading.model.exercise import load_exercise
from course_kit.learner import progress, workspace
from course_kit.text.console import note, wrap_text

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from course_kit.grading import Report

_POLL_S = 0.2  # asked for its state: editors replace the file, and network folders send no news
_GONE_POLLS = 10  # editors that write beside the file and rename need a moment; longer than this is worth a word
_NOT_GRADED = frozenset({"unreadable", "error"})


def watch_file(exercise_id: str, path: Path | None = None) -> int:
    """Grade at once and after each save, until Ctrl-C, which is the way to end it: 0."""
    exercise = load_exercise(exercise_id)
    path = workspace.choose_own(exercise, "watch")[0] if path is None else path
    if path.is_dir() and not exercise.files:
        raise GradingError(f"{path} is a folder. Name the .py or .ipynb file in it.")
    if not path.exists():
        raise GradingError(f"There is no file {path}.")
    best: Report | None = None
    before: Report | None = None
    worker = Worker()
    try:
        if advice := advice_for_root():
            print("\n".join(wrap_text(f"{advice[:1].upper()}{advice[1:]}")))
        print(f"Watching {path}: it is graded each time you save it. Ctrl-C ends.", flush=True)
        for _ in wait_for_saves(path, threading.Event()):
            try:
                report = grade(exercise.id, path, worker=worker)
            except GradingError:  # killed for want of memory, perhaps; a new one deserves its chance
                worker.close()
                worker = Worker()
                report = grade(exercise.id, path, worker=worker)
            note(progress.record_report(report))
            print(verdict_card(report, before), flush=True)
            before = report
            best = report if best is None or report.score > best.score else best
    except KeyboardInterrupt:
        print("\nNo longer watching." + ("" if best is None else f" Best: {best.verdict}."))
    finally:
        worker.close()
    return 0


def wait_for_saves(path: Path, stop: threading.Event, poll_s: float = _POLL_S) -> Iterator[None]:
    """Yield once at the beginning and once after each save, when the file has come to rest; ends when `stop` is set."""
    seen = before = None
    misses = 0
    while not stop.wait(poll_s):
        now = _signature(path)
        misses = misses + 1 if now is None else 0
        if misses == _GONE_POLLS:
            print(f"{path} is gone. Waiting for it to come back.", flush=True)
        if now is not None and now == before and now != seen:
            seen = now
            yield
        before = now


def _signature(path: Path) -> list[tuple[int, int, int]] | None:
    """What differs after each save: the time, the size, or with editors that rename the file itself."""
    try:
        seen = [file.stat() for file in (sorted(path.iterdir()) if path.is_dir() else [path])]
    except OSError:
        return None
    return [(stat.st_mtime_ns, stat.st_size, stat.st_ino) for stat in seen]


def verdict_card(report: Report, before: Report | None) -> str:
    """The verdict in a few lines of at most 80 columns: what changed, what to fix first, and what else is wrong."""
    verdict = "Not graded." if report.status in _NOT_GRADED else f"{report.verdict} ({report.duration_s:.1f} s)"
    if (
        before
        and report.score != before.score
        and not (report.practice or {report.status, before.status} & _NOT_GRADED)
    ):
        verdict += f", {report.score - before.score:+g} since the last save"
    lines = ["", f"{time.strftime('%H:%M:%S')}  {verdict}"]
    failed = [check for check in report.checks if check.status in ("failed", "error")]
    for number, check in enumerate(failed):
        lines += wrap_text(f"FAIL  {check.title}", "  ", " " * 8)
        if number == 0:
            texts = (check.sent, check.expected, check.got, check.message, check.hint)
            for name, text in zip(("sent", "expected", "got", "why", "hint"), texts, strict=True):
                lines += wrap_text(f"{name:<9} {text}", " " * 8, " " * 18) if text else []
    if report.problem:
        lines += wrap_text(report.problem, "  ", "  ")
    skipped, passed = (sum(check.status == status for check in report.checks) for status in ("skipped", "passed"))
    if skipped:
        lines.append(f"  skip  {skipped} that need these to pass first")
    if passed:
        lines.append(f"  PASS  {passed} of {len(report.checks)} checks")
    return "\n".join(lines)

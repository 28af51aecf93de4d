"""What a learner has reached, in one file. `grade`, `%grade` and `watch` record; the engine of a class does not."""

from __future__ import annotations

import fcntl
import json
import threading
import time
from contextlib import contextmanager
from datetime import datetime, timezone
from typing import TYPE_CHECKING

import msgspec
from msgspec.structs import replace

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from course_kit.grading import Report

FORMAT_VERSION = 1
VARIABLE = environment.paths.PROGRESS_VARIABLE  # names another file; `off` keeps nothing, as for the tests
_PATIENCE_S = 5.0  # for another grader that is writing, which takes it some milliseconds
_POLL_S = 0.02
_COUNTED = ("graded", "crashed")  # a file that cannot be read, and a fault of ours, are no try


class ProgressError(Exception):
    """The file cannot be used; the text is for the user."""


class Failure(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The first check that failed in the last grading, which is the one to fix first."""

    check: str
    title: str
    diagnosis: str | None


class ProgressRecord(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One exercise."""

    best: float = 0.0
    tries: int = 0
    first_passed: str = ""
    last_try: str = ""
    failed: Failure | None = None
    hints: dict[str, int] = {}

    @property
    def passed(self) -> bool:
        """Whether it was ever passed; a later, worse try takes nothing away."""
        return bool(self.first_passed)


def record_report(report: Report) -> str:
    """Add a grading to the file."""
    if report.status not in _COUNTED:
        return ""
    failed = [Failure(check.id, check.title, check.diagnosis) for check in report.checks if check.status == "failed"]

    def record(old: ProgressRecord) -> ProgressRecord:
        tried = count_try(old, passed=report.passed and not report.part)
        return replace(tried, best=max(old.best, report.score), failed=next(iter(failed), None))

    return update_progress(report.exercise, record)


def count_try(old: ProgressRecord, *, passed: bool) -> ProgressRecord:
    """The record after one more try."""
    now = datetime.now(timezone.utc).isoformat(timespec="seconds")
    return replace(old, tries=old.tries + 1, last_try=now, first_passed=old.first_passed or (now if passed else ""))


def read_progress() -> tuple[dict[str, ProgressRecord], str]:
    """All records by exercise, none when they cannot be read, and what to tell the user about that."""
    try:
        path = environment.paths.progress_file()
        return {} if path is None else _read(path), ""
    except (ProgressError, OSError) as problem:
        return {}, _reason(problem)


def update_progress(exercise: str, change: Callable[[ProgressRecord], ProgressRecord | None]) -> str:
    """Replace one record by what `change` makes of it, None to forget it; nobody else writes meanwhile."""
    try:
        if (path := environment.paths.progress_file()) is not None:
            with _lock_file(path):
                records = _read(path)
                changed = change(records.pop(exercise, ProgressRecord()))
                after = records if changed is None else {**records, exercise: changed}
                content = {"format_version": FORMAT_VERSION, "exercises": after}
                text = json.dumps(content, indent=1, ensure_ascii=False, default=msgspec.to_builtins)
                environment.write_atomically(path, text, mode=0o600)  # whole, and nobody else's business
    except (ProgressError, OSError) as problem:
        return f"{_reason(problem)} Nothing was recorded."
    return ""


def _reason(problem: Exception) -> str:
    if isinstance(problem, OSError):
        return f"The progress file cannot be used: {problem.filename or 'it'}: {problem.strerror or problem}."
    return str(problem)


@contextmanager
def _lock_file(path: Path) -> Iterator[None]:
    """Hold the lock beside the file (which is replaced whole, so it cannot carry the lock); ends with its process."""
    deadline = time.monotonic() + _PATIENCE_S
    pause = threading.Event()  # never set: a lock cannot be waited for with a deadline, only asked for again
    with path.with_suffix(".lock").open("a") as lock:
        while True:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if time.monotonic() > deadline:
                    raise ProgressError(f"Another process has locked the progress file {path}.") from None
                pause.wait(_POLL_S)
        yield


def _read(path: Path) -> dict[str, ProgressRecord]:
    try:
        text = path.read_bytes()
    except FileNotFoundError:
        return {}
    try:
        content = msgspec.json.decode(text)
        version = content["format_version"]
        if isinstance(version, int) and version > FORMAT_VERSION:
            raise ProgressError(f"The progress file {path} was written by a newer course kit.")
        return msgspec.convert(content["exercises"], dict[str, ProgressRecord])
    except (msgspec.MsgspecError, ValueError, KeyError, TypeError, RecursionError):
        raise ProgressError(
            f"The progress file {path} is damaged. Rename it, and the course starts a new one."
        ) from None

"""What a class run keeps in the folder of its results: `run.json`, for others to go on with it, and a lock.

One run at a time writes there; the system releases the lock when its holder ends, however it ends.
"""

from __future__ import annotations

import fcntl
import getpass
import json
import os
import socket
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from course_kit.environment import write_atomically
from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import Exercise, load_exercise, read_exercise
from course_kit.grading.model.plain_data import convert_record
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

NOTE = "run.json"
LOCK = ".run.lock"  # stays when the run has ended: taking it away would let two hold it
_LONGEST = 1000  # bytes


class RunNote(msgspec.Struct):
    """What `run.json` holds."""

    format_version: int = 1
    seed: int | None = None
    exercise_folders: dict[str, str] = {}  # of the exercises that lie outside of the course


def write_note(out: Path, seed: int, exercises: Iterable[Exercise]) -> None:
    """Note a run."""
    folders = {exercise.id: exercise.folder for exercise in exercises}
    added = {name: str(folder.resolve()) for name, folder in folders.items() if exercise_folders.is_added(folder)}
    noted = RunNote(seed=seed, exercise_folders={**read_note(out).exercise_folders, **added})
    write_atomically(out / NOTE, f"{json.dumps(msgspec.to_builtins(noted))}\n")


def read_note(out: Path) -> RunNote:
    """What the run that has written into a folder has noted; empty where there was none, or it cannot be read."""
    try:
        return convert_record(json.loads((out / NOTE).read_text(encoding="utf-8")), RunNote)
    except (OSError, ValueError):
        return RunNote()


def exercise_of(out: Path, exercise_id: str) -> Exercise:
    """An exercise of the run that has written into a folder: as it is known now, else where the run has found it."""
    noted = read_note(out).exercise_folders.get(exercise_id)
    if noted is None or exercise_id in exercise_folders.find_exercises().folders:
        return load_exercise(exercise_id)
    if not Path(noted).is_dir():
        raise GradingError(f"The exercise {exercise_id} was in {noted}, and is gone. Name its folder with --exercises.")
    return read_exercise(Path(noted))


@contextmanager
def hold_folder(folder: Path) -> Iterator[None]:
    """Have a folder of results for this process alone; makes the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    # Closed when another program is started: nobody who outlives this process holds the lock.
    descriptor = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o666)
    try:
        _take(descriptor, folder)
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, _describe_this_run().encode(), 0)
        yield
    finally:
        os.close(descriptor)


def _take(descriptor: int, folder: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        holder = one_line(os.pread(descriptor, _LONGEST, 0).decode(errors="replace")) or "it has just begun"
        raise GradingError(
            f"Another run is at work in {folder}: {holder}. Wait until it has ended, or name another folder."
        ) from None
    except OSError as problem:
        raise GradingError(
            f"The file system of {folder} cannot lock files ({problem.strerror}), so that two runs could mix their "
            "results. Name a folder on a local disk."
        ) from problem


def _describe_this_run() -> str:
    try:
        user = getpass.getuser()
    except (OSError, KeyError, ImportError):  # a user whom the system does not know
        user = str(os.getuid())
    now = datetime.now().astimezone()
    return f"process {os.getpid()} of {user} on {socket.gethostname()}, since {now:%Y-%m-%d %H:%M:%S %z}"

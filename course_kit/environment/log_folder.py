"""Where ROS writes its logs, a file for each process."""

from __future__ import annotations

import os
from pathlib import Path

from course_kit.environment.paths import is_writable, state_dir

_LOGS_KEPT = 40


def is_chosen() -> bool:
    """Whether the user has chosen one that can be written, by themselves: without any, ROS does not start."""
    home = os.environ.get("ROS_HOME", "")
    chosen = os.environ.get("ROS_LOG_DIR") or (f"{home}/log" if home else "")
    return bool(chosen) and is_writable(Path(os.path.expanduser(chosen)))  # noqa: PTH111 - unlike Path's, never raises


def made() -> Path:
    """Where ROS writes a file per process; the oldest are removed so that the folder does not grow for ever."""
    folder = state_dir() / "log"
    folder.mkdir(parents=True, exist_ok=True)
    with os.scandir(folder) as entries:
        files = [entry for entry in entries if entry.name.endswith(".log")]
    if len(files) > 2 * _LOGS_KEPT:
        for old in sorted(files, key=_time_of)[:-_LOGS_KEPT]:
            Path(old.path).unlink(missing_ok=True)
    return folder


def _time_of(entry: os.DirEntry[str]) -> float:
    try:
        return entry.stat().st_mtime
    except FileNotFoundError:  # another process has just removed it
        return 0.0

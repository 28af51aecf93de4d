"""Steps aside for a real `ros2`."""

from __future__ import annotations

import os
import sys

_OURS = b"course_kit.ros2cli"  # stands in the script that an installer makes of our entry point
_BOOTSTRAP = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"


def find() -> str | None:
    """The first `ros2` on PATH that is not the course kit's, or None."""
    for folder in os.get_exec_path():
        candidate = os.path.join(folder, "ros2")  # noqa: PTH118 - pathlib is an import a fast command does without
        if os.path.isfile(candidate) and os.access(candidate, os.X_OK) and not _is_ours(candidate):  # noqa: PTH113
            return candidate
    return None


def clean_environment(environ: dict[str, str]) -> dict[str, str]:
    """`environ` without what the ROS wheels of this Python put there: the real command brings its own libraries."""
    clean = {name: value for name, value in environ.items() if name not in {_BOOTSTRAP, "PYTHONHOME"}}
    ours = os.path.join(sys.prefix, "")  # noqa: PTH118
    for name in ("LD_LIBRARY_PATH", "PYTHONPATH"):
        kept = [folder for folder in clean.get(name, "").split(os.pathsep) if folder and not folder.startswith(ours)]
        clean.pop(name, None)
        if kept:
            clean[name] = os.pathsep.join(kept)
    return clean


def step_aside() -> None:
    """Become the real command, on the course's graph; returns when there is none."""
    command = find()
    if command is None:
        return
    from course_kit import environment

    try:
        environment.apply()
    except environment.DomainError as problem:
        sys.stderr.write(f"{problem}\n")
        sys.exit(1)
    sys.stdout.flush()
    os.execve(command, [command, *sys.argv[1:]], clean_environment(dict(os.environ)))


def _is_ours(path: str) -> bool:
    try:
        with open(path, "rb") as script:  # noqa: PTH123
            return _OURS in script.read(2000)
    except OSError:
        return True  # nothing that could be run anyway

"""A copy of the course in a folder of its own, for tests that change its files, and its command as a child process."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent
TEMPERATURE = "temperature_service"
STARTER = REPOSITORY / "exercises" / TEMPERATURE / f"{TEMPERATURE}.py"
SOLUTION = REPOSITORY / "solutions" / TEMPERATURE / f"{TEMPERATURE}.py"


class Course:
    """The command of a course, with progress kept in a file of the test's own."""

    def __init__(self, folder: Path, root: Path = REPOSITORY) -> None:
        self.root = root
        self.progress = folder / "progress.json"

    def environ(self, **variables: str) -> dict[str, str]:
        changes = {"COURSE_KIT_PROGRESS": str(self.progress), "PYTHONPATH": str(self.root), **variables}
        return {**os.environ, **changes}

    def run(self, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "course_kit.cli", *arguments],
            cwd=self.root,
            env=self.environ(**variables),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            timeout=100,
            check=False,
        )


def copy_course(folder: Path) -> Course:
    """The course as it is handed to people, without git and without what was generated."""
    root = folder / "a course"
    leave = shutil.ignore_patterns("__pycache__", ".course", ".ipynb_checkpoints")
    for name in ("course_kit", "exercises", "solutions"):
        shutil.copytree(REPOSITORY / name, root / name, ignore=leave)
    (root / "notebooks").mkdir()
    shutil.copy(REPOSITORY / "pyproject.toml", root)
    return Course(folder, root)

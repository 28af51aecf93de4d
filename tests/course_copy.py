"""The command as a child process, and a copy of the course for tests that change its files."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

# A shell runs these three lines, and finds Python beside the program; Python sees a string.
BESIDE_ITS_PYTHON = b"""#!/bin/sh
'''exec' "$(dirname "$(realpath "$0")")/python" "$0" "$@"
' '''
"""
REPOSITORY = Path(__file__).resolve().parent.parent
TEMPERATURE = "temperature_service"
SOLUTION = REPOSITORY / "solutions" / TEMPERATURE / f"{TEMPERATURE}.py"


def starter(folder: Path, name: str = "starter.py") -> Path:
    """A file with the starter of exercise 1."""
    path = folder / name
    path.write_bytes((REPOSITORY / "exercises" / TEMPERATURE / f"{TEMPERATURE}.py").read_bytes())
    return path


class Course:
    """The command of a course, with progress kept in a file of the test's own."""

    def __init__(self, folder: Path, root: Path = REPOSITORY) -> None:
        self.root = root
        self.progress = folder / "progress.json"

    def command(self, *arguments: str) -> list[str]:
        return [sys.executable, "-m", "course_kit", *arguments]

    def environ(self, **variables: str) -> dict[str, str]:
        changes = {"COURSE_KIT_PROGRESS": str(self.progress), "PYTHONPATH": str(self.root), **variables}
        return {**os.environ, **changes}

    def run(self, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            self.command(*arguments),
            cwd=self.root,
            env=self.environ(**variables),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            timeout=300,
            check=False,
        )


def copy_course(folder: Path) -> Course:
    """The course as it is handed to people: no git, nothing generated but bytecode."""
    root = folder / "a course"
    leave = [".course", ".ipynb_checkpoints", "*.backup-*"]
    shutil.copytree(REPOSITORY / "course_kit", root / "course_kit", ignore=shutil.ignore_patterns(*leave))
    without = shutil.ignore_patterns(*leave, "__pycache__")
    shutil.copytree(REPOSITORY / "exercises", root / "exercises", ignore=without)
    (root / "notebooks").mkdir()
    shutil.copy(REPOSITORY / "pyproject.toml", root)
    return Course(folder, root)


def copy_with_notebooks(folder: Path) -> Course:
    """Such a copy with the notebooks and a working `./course`, which uses the Python environment of these tests."""
    course = copy_course(folder)
    leave = shutil.ignore_patterns(".ipynb_checkpoints", "__pycache__")
    shutil.copytree(REPOSITORY / "notebooks", course.root / "notebooks", ignore=leave, dirs_exist_ok=True)
    shutil.copytree(REPOSITORY / "course_setup", course.root / "course_setup", ignore=leave)
    for name in ("course", "hatch_build.py"):
        shutil.copy(REPOSITORY / name, course.root)
    environment = Path(sys.prefix).resolve()
    kind = environment.name.partition("-")[0]
    copied = course.root / ".venvs" / f"{kind}-copy"
    copied.mkdir(parents=True)
    shutil.copytree(environment / "bin", copied / "bin", symlinks=True)
    for program in (copied / "bin").iterdir():
        if not program.is_symlink() and (content := program.read_bytes()).startswith(b"#!"):
            head = 3 if content.startswith(b"#!/bin/sh\n") else 1
            program.write_bytes(BESIDE_ITS_PYTHON + b"\n".join(content.split(b"\n")[head:]))
    for part in environment.iterdir():
        if part.name != "bin":
            (copied / part.name).symlink_to(part)
    stamp = copied / ".course-stamp"  # names the folder it was made for
    stamp.unlink()
    made = (environment / stamp.name).read_text()
    stamp.write_bytes(os.fsencode(made.replace(f"\n{REPOSITORY}\n", f"\n{course.root}\n")))
    (course.root / ".venvs" / kind).symlink_to(copied.name)
    (course.root / ".venv").symlink_to(copied.relative_to(course.root))
    return course

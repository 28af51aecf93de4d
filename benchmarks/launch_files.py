"""What becomes of real launch files: `python benchmarks/launch_files.py FOLDER`.

FOLDER holds one folder for each repository. Every launch file in Python below it is read, and all its actions are
done but one: a process is not started, its program is only looked for. Timers fire at once, and processes end as
soon as they have started, so that event handlers have their turn. The table counts the files that start a Python
program of their own repository, below a line for each file.
"""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
from collections import Counter
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.launch import finder, package_index
from course_kit.launch.description import ProcessExited
from course_kit.launch.errors import LaunchError, ProgramError
from course_kit.launch.service import LaunchService

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from course_kit.launch.node import ProcessDescription

LIMIT_S = 30.0
MOST = 100  # processes of one file; more come of handlers that start one for each that has ended
RUNS, RUNS_IN_PART = "runs", "runs, without compiled programs that are not there"
NOT_PYTHON = "starts no Python program of its repository (not counted)"


class Reader(LaunchService):
    """Does everything but start processes."""

    def __init__(self) -> None:
        super().__init__(StringIO())
        self.started: list[list[str]] = []
        self.missing: list[str] = []

    def start(self, description: ProcessDescription) -> None:
        """Note a process, and say that it has ended."""
        self.started.append(description.command)
        if len(self.started) < MOST:
            self.emit(ProcessExited(description.action, description.label, description.command))
        for path in description.temporary:
            path.unlink(missing_ok=True)

    def call_later(self, seconds: float, function: Callable[[], object]) -> None:
        """Do it now."""
        super().call_later(0 * seconds, function)

    def fail(self, error: ProgramError) -> None:
        """Note a program that is not there."""
        self.missing.append(str(error))

    def say(self, text: str, *, shown: bool = True) -> None:
        """Print nothing."""


def one(file: Path) -> dict[str, object]:
    """Read one file; what has come of it."""
    finder.come_before_folders()
    reader, error = Reader(), ""
    try:
        reader.run(file, {})
    except LaunchError as problem:
        error = str(problem)
    python = [command for command in reader.started if command[0] == sys.executable]
    return {"python": len(python), "started": len(reader.started), "missing": reader.missing, "error": error}


def in_a_process(file: Path) -> dict[str, object]:
    """The same in a fresh process, from the folder of the file, within a time."""
    command = [sys.executable, str(Path(__file__).resolve()), "--one", str(file)]
    environ = {**os.environ, "ROS_DOMAIN_ID": "99", "USER": "learner"}
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False, env=environ)
    except subprocess.TimeoutExpired:
        return {"python": 0, "started": 0, "missing": [], "error": "does not end"}
    lines = [line for line in done.stdout.splitlines() if line.startswith('{"python"')]
    if lines:
        return dict(json.loads(lines[-1]))
    return {"python": 0, "started": 0, "missing": [], "error": f"dies: {done.stderr[-300:]}"}


def files_in(folder: Path) -> Iterator[Path]:
    """The launch files in Python."""
    for path in sorted(folder.rglob("*.py")):
        if path.is_file() and "\ndef generate_launch_description" in path.read_text(errors="replace"):
            yield path


def programs_in(repository: Path) -> set[str]:
    """The names of the Python programs of a repository's packages."""
    found: set[str] = set()
    for description in repository.rglob("package.xml"):
        folder = description.parent
        found |= set(package_index.read_programs(folder))
        for place in ("scripts", "nodes", "src", folder.name):
            found |= {path.name for path in (folder / place).glob("*.py")}
    return found


def names_one_of(file: Path, programs: set[str]) -> bool:
    """Whether a launch file names a Python program of its repository."""
    try:
        tree = ast.parse(file.read_text(errors="replace"))
    except SyntaxError:
        return False
    keywords = (node for node in ast.walk(tree) if isinstance(node, ast.keyword))
    values = (node.value for node in keywords if node.arg in {"executable", "node_executable"})
    return any(isinstance(value, ast.Constant) and value.value in programs for value in values)


def verdict(found: dict[str, object]) -> str:
    """The row of the table that a result belongs to."""
    error = str(found["error"])
    rules = {
        "compiled programs need": "out of scope: components, lifecycle nodes",
        "is not part of the course kit": "fails: not part of the subset",
        "has no argument": "fails: an argument that is not part of the subset",
        "No module named": "needs a Python package that is not there",
        "not found": "needs a package that is not there",
        "Command(": "needs a program that is not there",
        "There is no": "needs a file that is not there",
        "is required": "needs an argument",
    }
    if error:
        return next((row for mark, row in rules.items() if mark in error), "fails: a mistake in the file")
    return RUNS_IN_PART if found["missing"] else RUNS


def main() -> None:
    if sys.argv[1] == "--one":
        print("\n" + json.dumps(one(Path(sys.argv[2]))))
        return
    rows: Counter[str] = Counter()
    for repository in sorted(path for path in Path(sys.argv[1]).iterdir() if path.is_dir()):
        programs = programs_in(repository)
        for file in files_in(repository):
            found = in_a_process(file)
            counts = bool(found["python"]) or names_one_of(file, programs)
            row = verdict(found) if counts else NOT_PYTHON
            rows[row] += 1
            print(file.relative_to(repository.parent), row, found["error"], found["missing"], sep=" | ")
    counted = sum(number for row, number in rows.items() if row != NOT_PYTHON)
    print(
        f"\n| {counted} launch files that start a Python program of their repository | files | share |\n|---|---|---|"
    )
    for row, number in rows.most_common():
        share = "" if row == NOT_PYTHON else f"{number / counted:.0%}"
        print(f"| {row} | {number} | {share} |")


if __name__ == "__main__":
    main()

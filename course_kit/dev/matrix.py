"""`course-kit dev matrix`: the fast part of the suite on other Pythons, installed by pip and by uv.

For each combination it copies the course into a fresh folder with a space in its name, has `./course` set it up there,
asks the doctor, grades the four solutions and runs every notebook with nbval. The table goes to
artifacts/python_matrix.md.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.dev import pythons

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from course_kit.dev.pythons import Interpreter

INSTALLERS = ("pip", "uv")
TABLE = Path("artifacts/python_matrix.md")
_STEP_S = 1200.0  # against hanging only
_TAIL = 40  # lines of a failed step that are shown
# Of the environment this runs in; what belongs to a user's set-up of pip, uv or a proxy is passed on.
_NOT_PASSED_ON = ("VIRTUAL_ENV", "LD_LIBRARY_PATH", "RMW_IMPLEMENTATION")
_NOT_PASSED_ON_PREFIXES = ("PYTHON", "ROS", "_ROS", "COURSE", "FAST", "PYTEST", "AMENT")


@dataclass
class Combination:
    """One Python with one installer, and how each step went: its seconds, or why it failed."""

    python: Interpreter
    installer: str
    steps: dict[str, str] = field(default_factory=dict)
    failed: bool = False


def main(arguments: Sequence[str]) -> int:
    """Run the matrix; returns 0 when everything passed, 1 when something failed, 2 when it cannot be run."""
    parser = argparse.ArgumentParser(prog="course-kit dev matrix", description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument(
        "--all", action="store_true", help="every Python, not the oldest and the newest beside this one"
    )
    options = parser.parse_args(arguments)
    root = environment.checkout()
    if root is None or not (root / "solutions").is_dir():
        print("course-kit: the matrix needs the whole course, with its solutions.", file=sys.stderr)
        return 2
    found = pythons.find()
    chosen = found if options.all else _others(found)
    if missing := [version for version in pythons.wanted() if version not in {one.minor for one in found}]:
        print(f"Not on this machine, and so not run: Python {', '.join(missing)}.", flush=True)
    combinations = [Combination(one, installer) for one in chosen for installer in _installers(one)]
    with tempfile.TemporaryDirectory(prefix="course matrix ") as folder:
        for one in combinations:
            _run(one, root, Path(folder))
    table = render(combinations)
    (root / TABLE).parent.mkdir(exist_ok=True)
    (root / TABLE).write_text(f"{table}\n", encoding="utf-8")
    print(f"\n{table}\n", flush=True)
    return int(any(one.failed for one in combinations))


def render(combinations: Sequence[Combination]) -> str:
    """The table."""
    steps = list(dict.fromkeys(step for one in combinations for step in one.steps))
    lines = [f"| Python | installer | {' | '.join(steps)} |", f"|---|---|{'---|' * len(steps)}"]
    for one in combinations:
        cells = [one.steps.get(step, "not run") for step in steps]
        lines.append(f"| {one.python} | {one.installer} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _others(found: Sequence[Interpreter]) -> list[Interpreter]:
    """The oldest and the newest besides the one that everything else is tested on."""
    others = [one for one in found if one.version[:2] != sys.version_info[:2]]
    return list(dict.fromkeys([*others[:1], *others[-1:]]))


def _installers(python: Interpreter) -> Iterator[str]:
    if python.has_venv:
        yield "pip"
    if _uv():
        yield "uv"


def _uv() -> str | None:
    return shutil.which("uv", path=os.pathsep.join([str(Path(sys.prefix) / "bin"), os.environ.get("PATH", "")]))


def _run(one: Combination, root: Path, folder: Path) -> None:
    """All steps of a combination, up to the first that fails."""
    course = folder / f"course {one.python.minor} {one.installer}"
    tools = folder / f"tools of {one.installer}"
    _copy(root, course)
    environ = _environ(one, tools, folder)
    steps: dict[str, Callable[[], list[list[str]]]] = {
        "set-up, doctor": lambda: [["./course", "doctor"]],
        "four gradings": lambda: [_grade(exercise) for exercise in _exercises(course)],
        "nbval of all notebooks": lambda: [[".venv/bin/python", "-m", "course_kit.dev.suite", "--notebooks"]],
    }
    print(f"== Python {one.python} with {one.installer}", flush=True)
    for name, commands in steps.items():
        began = time.monotonic()
        problem = next((text for command in commands() if (text := _fails(command, course, environ))), "")
        one.steps[name] = "**failed**" if problem else f"{time.monotonic() - began:.0f} s"
        print(f"   {name}: {one.steps[name].strip('*')}{problem}", flush=True)
        if problem:
            one.failed = True
            return
    shutil.rmtree(course)


def _copy(root: Path, target: Path) -> None:
    """The files of a checkout as they are now, without what is generated."""
    listed = subprocess.run(
        ["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        capture_output=True,
        check=True,
    )
    for name in map(os.fsdecode, listed.stdout.split(b"\0")):
        if name and (root / name).is_file():
            (target / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, target / name)


def _environ(one: Combination, tools: Path, folder: Path) -> dict[str, str]:
    """The environment of a terminal in which nothing of the course was started, with the installer in question."""
    kept = {
        name: value
        for name, value in os.environ.items()
        if name not in _NOT_PASSED_ON and not name.startswith(_NOT_PASSED_ON_PREFIXES)
    }
    own = str(Path(sys.prefix) / "bin")
    path = [entry for entry in os.environ.get("PATH", "").split(os.pathsep) if entry and Path(entry) != Path(own)]
    if one.installer == "uv":
        tools.mkdir(exist_ok=True)
        link = tools / "uv"
        if not link.is_symlink():
            link.symlink_to(_uv() or "")
        path.insert(0, str(tools))
    state = folder / "state"
    changed = {"PATH": os.pathsep.join(path), "COURSE_PYTHON": one.python.path, "XDG_STATE_HOME": str(state)}
    return {**kept, **changed, **({} if one.installer == "uv" else {"COURSE_NO_UV": "1"}), "COURSE_KIT_PROGRESS": "off"}


def _exercises(course: Path) -> list[str]:
    return sorted(path.parent.name for path in course.glob("exercises/*/exercise.toml"))


def _grade(exercise: str) -> list[str]:
    return ["./course", "grade", exercise, f"solutions/{exercise}/{exercise}.py", "--format", "json"]


def _fails(command: list[str], course: Path, environ: dict[str, str]) -> str:
    """The end of what a command has printed, if it has failed; a grading below full marks has."""
    with subprocess.Popen(
        command,
        cwd=course,
        env=environ,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT if "json" not in command else None,
        text=True,
        start_new_session=True,
    ) as process:
        try:
            printed, _ = process.communicate(timeout=_STEP_S)
        except BaseException:  # Ctrl-C among them: nothing that was started may stay
            os.killpg(process.pid, signal.SIGTERM)
            raise
    right = process.returncode == 0
    if right and "json" in command:
        report = json.loads(printed)
        right = report["score"] == report["max_score"]
    return "" if right else "\n" + "\n".join([" ".join(command), *printed.splitlines()[-_TAIL:]])

"""The course on each Python of the machine: which are found, what is tried, what is said, and that nothing is left.

Setting up takes a network and minutes, so here a stand-in for `./course` does as it is told; the real one is set up by
the matrix that ends `./course test` on CI.
"""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit.dev import matrix, notebooks, pythons
from course_kit.dev.pythons import Interpreter
from tests.course_copy import copy_course
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Sequence

THIS = f"{sys.version_info[0]}.{sys.version_info[1]}"
STAND_IN_COURSE = """#!/bin/sh
# Stands in for the course's own script: what would take a network or long is done at once, and noted.
echo "$COURSE_PYTHON $(pwd) $*" >>"$STAND_IN_LOG"
case $1 in
  doctor) if [ -n "${STAND_IN_PIPE:-}" ]; then echo $$ >"$STAND_IN_PIPE"; read -r _ <"$STAND_IN_PIPE"; fi
    mkdir -p .venv/bin
    printf '#!/bin/sh\\necho "- - $(pwd) python $*" >>"$STAND_IN_LOG"\\n' >.venv/bin/python
    chmod +x .venv/bin/python
    exit "${STAND_IN_DOCTOR:-0}" ;;
  grade) echo "{\\"score\\": ${STAND_IN_SCORE:-10}, \\"max_score\\": 10}" ;;
  dev) setsid sleep 300 & echo $! >"$STAND_IN_DETACHED" ;;
esac
"""


class Tried:
    """A course with a stand-in for its script, and what a run of the matrix in it has left."""

    def __init__(self, folder: Path) -> None:
        self.course = copy_course(folder)
        self.temporary = folder / "temporary"
        self.temporary.mkdir()
        self.log, self.detached, self.pipe = folder / "log", folder / "detached", folder / "pipe"
        self.log.touch()
        (self.course.root / "course").write_text(STAND_IN_COURSE)
        (self.course.root / "course").chmod(0o755)
        solution = self.course.root / "solutions/temperature_service/temperature_service.py"
        solution.parent.mkdir(parents=True)
        solution.touch()

    def start(self, **variables: str) -> subprocess.Popen[str]:
        environ = self.course.environ(
            TMPDIR=str(self.temporary),
            STAND_IN_LOG=str(self.log),
            STAND_IN_DETACHED=str(self.detached),
            **variables,
        )
        command = self.course.command("dev", "matrix", "--python", THIS)
        return subprocess.Popen(
            command, cwd=self.course.root, env=environ, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )

    def run(self, **variables: str) -> tuple[int, str]:
        with self.start(**variables) as process:
            said, _ = process.communicate(timeout=100)
        return process.returncode, said

    def rows(self) -> list[str]:
        table = (self.course.root / "artifacts/python_matrix.md").read_text()
        return [line for line in table.splitlines() if line.startswith("|")]

    def left(self) -> list[str]:
        """Folders of the matrix that are still there."""
        return [path.name for path in self.temporary.glob("course matrix*")]


@pytest.fixture
def tried(tmp_path: Path) -> Tried:
    return Tried(tmp_path)


def is_gone(process_id: int) -> bool:
    try:
        return Path(f"/proc/{process_id}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except FileNotFoundError:
        return True


def test_each_step_is_run_and_told_and_nothing_is_left(tried: Tried) -> None:
    code, said = tried.run()
    assert code == 0, said
    header, _, row = tried.rows()
    assert header == "| Python | set-up and doctor | temperature_service | nbval | notebooks |"
    assert row.startswith(f"| {THIS}.")
    assert row.count("passed, ") == 4
    calls = [line.partition("/my course ")[2] for line in tried.log.read_text().splitlines()]
    assert calls == [
        "doctor",
        "grade temperature_service solutions/temperature_service/temperature_service.py --format json",
        f"python -m pip install --quiet {notebooks.requirement()}",
        "dev notebooks",
    ]
    assert f"{Path(sys.executable).resolve().parent}" in tried.log.read_text()  # COURSE_PYTHON, none of an environment
    assert is_gone(int(tried.detached.read_text()))
    assert tried.left() == []


@pytest.mark.parametrize(
    ("variables", "cells"),
    [
        ({"STAND_IN_SCORE": "9.5"}, ["passed", "FAILED: 9.5 of 10 points.", "passed", "passed"]),
        ({"STAND_IN_SCORE": "x"}, ["passed", "FAILED: there is no report.", "passed", "passed"]),
        ({"STAND_IN_DOCTOR": "1"}, ["FAILED: exit code 1"]),
    ],
)
def test_what_fails_is_named_and_fails_the_whole(tried: Tried, variables: dict[str, str], cells: list[str]) -> None:
    code, _ = tried.run(**variables)
    assert code == 1
    _, _, row = tried.rows()
    assert [cell.rpartition(",")[0].strip() for cell in row.split("|")[2:-1]] == cells


def test_ctrl_c_leaves_nothing(tried: Tried) -> None:
    os.mkfifo(tried.pipe)
    running = tried.start(STAND_IN_PIPE=str(tried.pipe))
    setting_up = int(tried.pipe.read_text())
    assert len(tried.left()) == 1
    running.send_signal(signal.SIGINT)
    said, _ = running.communicate(timeout=60)
    assert running.returncode == 130, said
    assert tried.left() == []
    wait_until(lambda: is_gone(setting_up), "the end of the set-up")


def test_a_python_that_is_asked_for_and_is_not_here_is_named(tried: Tried) -> None:
    done = tried.course.run("dev", "matrix", "--python", "2.7", "--python", THIS)
    assert done.returncode == 2
    assert done.stderr.startswith("course-kit: there is no Python 2.7 here; there is ")
    assert THIS in done.stderr
    assert tried.log.read_text() == ""


@pytest.mark.parametrize(
    "variables",
    [
        {"PATH": "pyenv/shims"},
        {"PATH": "nothing", "PYENV_ROOT": "pyenv"},
        {"PATH": "pyenv/versions/mine/bin"},
        {"PATH": "nothing", "UV_PYTHON_INSTALL_DIR": "pyenv/versions"},
    ],
)
def test_pythons_are_found_wherever_they_are_and_those_that_do_not_start_are_not(
    variables: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken, empty = tmp_path / "pyenv/shims", tmp_path / "nothing"
    broken.mkdir(parents=True)
    for name in ("python3", "python3.10", "python3.13"):
        (broken / name).write_text("#!/bin/sh\necho 'pyenv: command not found' >&2\nexit 127\n")
        (broken / name).chmod(0o755)
    here = tmp_path / "pyenv/versions/mine/bin"
    here.mkdir(parents=True)
    (here / "python3").symlink_to(Path(sys.executable).resolve())
    for name in ("HOME", "XDG_DATA_HOME", "UV_PYTHON_INSTALL_DIR", "PYENV_ROOT"):
        monkeypatch.setenv(name, str(empty))
    for name, value in variables.items():
        monkeypatch.setenv(name, str(tmp_path / value))
    monkeypatch.setattr(sys, "executable", str(empty / "python"))  # else this Python would be found by that
    [found] = pythons.find()
    assert found.version == sys.version_info[:3]


OLD, MIDDLE, NEW = (Interpreter((3, minor, 1), f"/python3.{minor}", has_venv=True) for minor in (10, 12, 14))
RUNNING = Interpreter(sys.version_info[:3], "/python", has_venv=True)


def chosen(found: Sequence[Interpreter], *, has_uv: bool = True, **options: object) -> tuple[list[str], list[str]]:
    defaults: dict[str, object] = {"python": None, "ends": False, "tests": False}
    combinations, notes = matrix.choose(found, argparse.Namespace(**{**defaults, **options}), has_uv=has_uv)
    return [one.python.minor for one in combinations], notes


def test_everything_is_tried_unless_less_is_asked_for() -> None:
    assert chosen([OLD, MIDDLE, NEW])[0] == ["3.10", "3.12", "3.14"]
    assert chosen([OLD, MIDDLE, NEW], python=["3.12"])[0] == ["3.12"]


def test_the_ends_are_the_oldest_and_the_newest_besides_this_python() -> None:
    others = [one for one in (OLD, MIDDLE, NEW) if one.minor != THIS]
    found = sorted([*others, RUNNING], key=lambda one: one.version)
    first, last = others[0].minor, others[-1].minor
    assert chosen(found, ends=True)[0] == [first, last]


@pytest.mark.parametrize("drills", [True, False])
def test_the_ends_run_the_lessons_and_not_the_drills(drills: bool) -> None:
    combination = matrix.Combination(NEW, drills=drills)
    course = Path(__file__).resolve().parents[2]
    command = next(step.command for step in matrix.steps_of(combination, course) if step.name == "notebooks")
    named = [Path(one).relative_to(course).parts[0] for one in command[3:]]
    assert set(named) == (set() if drills else {"notebooks"})


@pytest.mark.parametrize(
    ("found", "has_uv", "tried_", "note"),
    [
        ([RUNNING], True, [], "no other Python"),
        ([], True, [], "no other Python"),
        ([Interpreter((3, 9, 1), "/python3.9", has_venv=False)], False, [], "comes without venv"),
        (
            [Interpreter((3, 8, 1), "/python3.8", has_venv=True), Interpreter((3, 9, 1), "/python3.9", has_venv=False)],
            False,
            ["3.8"],
            "comes without venv",
        ),
    ],
)
def test_what_is_missing_is_said_and_is_no_failure(
    found: list[Interpreter], has_uv: bool, tried_: list[str], note: str
) -> None:
    combinations, notes = chosen(found, has_uv=has_uv, ends=True)
    assert combinations == tried_
    assert note in " ".join(notes)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [((), False), (("--all",), True), (("--matrix", "tests"), True)],
)
def test_the_suite_ends_with_it_when_asked(tried: Tried, arguments: tuple[str, ...], expected: bool) -> None:
    """Of the suite only a test that passes is there, and no notebook."""
    (tried.course.root / "tests").mkdir()
    (tried.course.root / "tests/test_one.py").write_text("def test_one() -> None:\n    assert True\n")
    environ = tried.course.environ(
        TMPDIR=str(tried.temporary),
        COURSE_BROWSER=sys.executable,  # nothing is to be installed for this
        STAND_IN_LOG=str(tried.log),
        STAND_IN_DETACHED=str(tried.detached),
    )
    suite = [sys.executable, "-m", "course_kit.dev.suite", *arguments]
    done = subprocess.run(
        suite, cwd=tried.course.root, env=environ, capture_output=True, text=True, timeout=100, check=False
    )
    assert "1 passed" in done.stdout
    assert (tried.course.root / "artifacts/python_matrix.md").exists() is expected
    assert tried.left() == []

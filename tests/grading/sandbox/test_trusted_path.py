"""Files that lie beside a submission are never loaded by the grader's own processes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import sysconfig
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.grading.conftest import EXERCISE, ROOT

STARTER = ROOT / "exercises" / EXERCISE / f"{EXERCISE}.py"
# What the grader, the class command and their libraries import, and anything else of Python's own.
NAMES = {*sys.stdlib_module_names, "rclpy", "numpy", "yaml", "tomli", "platformdirs", "lark", "nbformat", "distributed"}
OFTEN_IMPORTED = {"rclpy", "numpy", "yaml", "json", "signal"}
COMMANDS = {
    "script": [str(Path(sysconfig.get_path("scripts")) / "course-kit")],
    "door": [
        sys.executable,
        "-c",
        "import sys; del sys.path[0]; from course_kit.__main__ import main; sys.exit(main())",
    ],
}


@pytest.fixture
def inbox(tmp_path: Path) -> Path:
    """A folder with a submission, and with modules that leave a mark when somebody imports them."""
    folder = tmp_path / "inbox"
    folder.mkdir()
    (folder / f"{EXERCISE}.py").write_text(STARTER.read_text())
    trap = f"open({str(tmp_path / 'loaded')!r}, 'a').write(__name__ + chr(10))\nraise ImportError('planted')\n"
    for name in NAMES - {"__main__", "site", "sitecustomize"}:
        (folder / f"{name}.py").write_text(trap)
    return folder


def course_kit(command: list[str], inbox: Path, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    environ = {**os.environ, **variables}
    return subprocess.run(
        [*command, *arguments], cwd=inbox, env=environ, capture_output=True, text=True, timeout=300, check=False
    )


@pytest.mark.parametrize("kind", COMMANDS)
def test_grade_loads_nothing_from_beside_a_submission(kind: str, inbox: Path) -> None:
    done = course_kit(COMMANDS[kind], inbox, "grade", EXERCISE, f"{EXERCISE}.py")
    assert done.returncode == 1, done.stderr
    assert "of 10 points" in done.stdout
    assert not (inbox.parent / "loaded").exists(), (inbox.parent / "loaded").read_text()


def test_class_loads_nothing_from_the_folder_it_grades(inbox: Path) -> None:
    for trap in inbox.iterdir():  # each is read as if it was handed in
        if trap.stem not in {EXERCISE, *OFTEN_IMPORTED}:
            trap.unlink()
    out = inbox.parent / "results"
    asked = ["class", ".", "--exercise", EXERCISE, "--out", str(out), "--layout", "files"]
    done = course_kit(COMMANDS["script"], inbox, *asked)
    assert (out / "grades.csv").is_file(), done.stderr
    assert not (inbox.parent / "loaded").exists(), (inbox.parent / "loaded").read_text()


def test_an_autograder_loads_nothing_from_the_folder_it_grades(inbox: Path) -> None:
    asked = ["grade", EXERCISE, ".", "--format", "gradescope", "--to", "../result"]
    done = course_kit(COMMANDS["script"], inbox, *asked)
    assert done.returncode == 0, done.stderr
    assert json.loads((inbox.parent / "result").read_text())["score"] >= 0
    assert not (inbox.parent / "loaded").exists(), (inbox.parent / "loaded").read_text()


def test_the_worker_has_no_folder_of_a_submission_on_its_path_whatever_pythonpath_says(inbox: Path) -> None:
    """An empty entry of PYTHONPATH means the working directory; the traps would go off in the worker."""
    program = (
        "import os, sys; sys.path[:] = [p for p in sys.path if p not in ('', os.getcwd())]\n"
        "os.environ['PYTHONPATH'] = os.pathsep\n"
        "from course_kit import grading\n"
        f"print(grading.grade({EXERCISE!r}, {f'{EXERCISE}.py'!r}).status)"
    )
    done = course_kit([sys.executable, "-c"], inbox, program)
    assert done.stdout == "graded\n", done.stderr
    assert not (inbox.parent / "loaded").exists(), (inbox.parent / "loaded").read_text()


def test_jupyterlab_loads_nothing_from_the_folder_it_is_started_in(inbox: Path) -> None:
    """Its kernels and terminals do, as everywhere: they run what lies there."""
    done = course_kit(COMMANDS["script"], inbox, "lab", str(inbox.parent / "lessons"), "--allow-root", "--version")
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == version("jupyterlab")
    assert not (inbox.parent / "loaded").exists(), (inbox.parent / "loaded").read_text()

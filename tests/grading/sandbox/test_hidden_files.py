"""Of exercises that lie among libraries a submission sees no solution and no grader, wherever these lie."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest

from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import read_exercise
from course_kit.grading.workers import exercise_job
from tests import outside_exercises
from tests.outside_exercises import ID
from tests.refused import WITHOUT_NAMESPACES

if TYPE_CHECKING:
    from pathlib import Path

OTHER = "other_exercise"
SPY = """
import os, subprocess, sys
for folder, _, names in os.walk({site}):
    for name in names:
        try:
            if {secret} in open(os.path.join(folder, name), errors="replace").read():
                print("WON: read", os.path.join(folder, name))
        except OSError:
            pass
for name in ("my_graders.three", "my_graders.helpers", "single_grader"):
    try:
        module = __import__(name)
        print("WON: imported", name) if hasattr(module, "CHECKS") or "." in name else None
    except (ImportError, OSError):
        pass
import visible
from three_interfaces.srv import Three
print("INTERFACE", Three.__name__, flush=True)
subprocess.run([sys.executable, "-c", "import visible, rclpy; print('IN A NEW PYTHON')"])
"""
GRADE = """
import json, sys
from course_kit import grading
with grading.Worker() as worker:
    found = worker.ready()
    reports = [grading.grade(sys.argv[1], program, worker=worker) for program in sys.argv[2:]]
held = found.files or found.landlock
print(json.dumps([held, *([one.score, one.problem, one.stdout, one.stderr] for one in reports)]))
"""
SECRET = "NOT_FOR_SUBMISSIONS"  # noqa: S105 - a text to look for


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """Two exercises among libraries, their graders and solutions in four other places."""
    made = tmp_path / "site"
    text = f"# {SECRET}\n"
    package = made / "my_exercises"
    for name, solution, grader in (
        (ID, "../../answers/x.py", "my_graders.three"),
        (OTHER, "../../one_file.py", "single_grader"),
    ):
        folder = outside_exercises.write(package, name)
        toml = folder / "exercise.toml"
        named = toml.read_text().replace("solution/add_three.py", solution).replace("checks.py", grader)
        toml.write_text(named)
        (folder / "solution" / "add_three.py").unlink()
        (folder / "checks.py").unlink()
    checks = outside_exercises.CHECKS.replace(".samples", "my_graders.helpers")
    texts = {
        "my_graders/helpers.py": text + outside_exercises.SAMPLES,
        "my_graders/__init__.py": text,
        "my_graders/three.py": text + checks,
        "my_graders/beside.py": text,
        "single_grader.py": f'"""{SECRET}"""\n{checks}',  # what Python writes of it has it, too
        "answers/x.py": text + outside_exercises.SOLUTION,
        "answers/beside.py": text,
        "one_file.py": text + outside_exercises.SOLUTION,
        "visible.py": "print('VISIBLE')\n",
    }
    for place, written in texts.items():
        path = made / place
        path.parent.mkdir(exist_ok=True)
        path.write_text(written)
    cached = "import py_compile, sys; py_compile.compile(sys.argv[1])"
    subprocess.run([sys.executable, "-c", cached, str(made / "single_grader.py")], check=True, timeout=200)
    return made


@pytest.mark.parametrize(
    ("name", "before"), [(ID, ""), (OTHER, WITHOUT_NAMESPACES)], ids=["by namespaces", "by Landlock"]
)
def test_solution_and_grader_are_hidden_and_both_work(name: str, before: str, site: Path, tmp_path: Path) -> None:
    spy, right = tmp_path / "spy.py", tmp_path / "right.py"
    spy.write_text(SPY.replace("{site}", repr(str(site))).replace("{secret}", repr(SECRET)))
    right.write_text(outside_exercises.SOLUTION)
    command = [sys.executable, "-c", before + GRADE, name, str(spy), str(right)]
    environ = {**os.environ, "PYTHONPATH": str(site), exercise_folders.VARIABLE: str(site / "my_exercises")}
    done = subprocess.run(command, env=environ, capture_output=True, text=True, timeout=200, check=False)
    assert done.returncode == 0, done.stderr
    found: list[Any] = json.loads(done.stdout)
    held, (_, problem, stdout, stderr), (score, *rest) = found
    lines = [line for line in stdout.splitlines() if held or not line.startswith("WON")]
    assert lines == ["VISIBLE", "INTERFACE Three", "VISIBLE", "IN A NEW PYTHON"], (problem, stderr)
    assert score == 3.0, rest


def test_what_an_exercise_names_is_found_without_running_its_package(site: Path) -> None:
    (site / "my_graders" / "__init__.py").write_text("raise RuntimeError('it was run')\n")
    program = (
        "import sys; sys.path.insert(0, sys.argv[1]); from course_kit.grading.workers import exercise_job; "
        "from course_kit.grading.model.exercise import load_exercise; "
        f"print(*exercise_job.hidden_files_of(load_exercise('{ID}')), sep='\\n')"
    )
    command = [sys.executable, "-c", program, str(site)]
    environ = {**os.environ, exercise_folders.VARIABLE: str(site / "my_exercises")}
    done = subprocess.run(command, env=environ, capture_output=True, text=True, timeout=200, check=True)
    names = ("answers", f"my_exercises/{ID}", f"my_exercises/{OTHER}", "my_graders", "one_file.py")
    hidden = {line for line in done.stdout.splitlines() if "__pycache__" not in line}
    assert hidden == {str(site / name) for name in (*names, "single_grader.py")}


def test_a_mistake_in_one_exercise_hides_the_others_none_the_less(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(exercise_folders.VARIABLE, str(site / "my_exercises"))
    monkeypatch.syspath_prepend(site)
    exercise = read_exercise(site / "my_exercises" / ID)
    (site / "my_exercises" / OTHER / "exercise.toml").write_text("id = ")
    assert {str(site / "answers"), str(site / "my_exercises" / OTHER)} <= set(exercise_job.hidden_files_of(exercise))

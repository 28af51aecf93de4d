"""Of exercises that lie among libraries a submission sees no solution and no grader."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest

from course_kit.grading.model import exercise_folders
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
    """Two exercises of an own course among libraries: a solution beside them, and one in the exercise's folder."""
    made = tmp_path / "site"
    for name in (ID, OTHER):
        folder = outside_exercises.write(made / "exercises", name)
        for path in (folder / "checks.py", folder / "solution" / "add_three.py"):
            path.write_text(f"# {SECRET}\n{path.read_text()}")
    toml = made / "exercises" / ID / "exercise.toml"
    toml.write_text(toml.read_text().replace('solution = "solution/add_three.py"\n', ""))
    (made / "solutions" / ID).mkdir(parents=True)
    (made / "exercises" / ID / "solution" / "add_three.py").rename(made / "solutions" / ID / "add_three.py")
    (made / "visible.py").write_text("print('VISIBLE')\n")
    return made


@pytest.mark.parametrize(
    ("name", "before"), [(ID, ""), (OTHER, WITHOUT_NAMESPACES)], ids=["by namespaces", "by Landlock"]
)
def test_solution_and_grader_are_hidden_and_both_work(name: str, before: str, site: Path, tmp_path: Path) -> None:
    spy, right = tmp_path / "spy.py", tmp_path / "right.py"
    spy.write_text(SPY.replace("{site}", repr(str(site))).replace("{secret}", repr(SECRET)))
    right.write_text(outside_exercises.SOLUTION)
    command = [sys.executable, "-c", before + GRADE, name, str(spy), str(right)]
    environ = {**os.environ, "PYTHONPATH": str(site), exercise_folders.VARIABLE: str(site / "exercises")}
    done = subprocess.run(command, env=environ, capture_output=True, text=True, timeout=200, check=False)
    assert done.returncode == 0, done.stderr
    found: list[Any] = json.loads(done.stdout)
    held, (_, problem, stdout, stderr), (score, *rest) = found
    lines = [line for line in stdout.splitlines() if held or not line.startswith("WON")]
    assert lines == ["VISIBLE", "INTERFACE Three", "VISIBLE", "IN A NEW PYTHON"], (problem, stderr)
    assert score == 3.0, rest

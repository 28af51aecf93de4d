"""Of an exercise outside of the course's folder a submission sees the interfaces, and nothing else."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from course_kit import grading
from course_kit.grading import engine
from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.model.submission import Submission
from tests import outside_exercises
from tests.outside_exercises import ID

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

SPY = """
import gc, os, sys
folders = {folders}
for folder in folders:
    for name in ("checks.py", "samples.py", "exercise.toml", "solution/add_three.py", "proof/broken/no_sum.py"):
        path = os.path.join(folder, name)
        try:
            print("WON: read", path, len(open(path).read()))
        except OSError:
            pass
    for place, _, files in os.walk(folder):
        for name in files:
            print("SEEN", os.path.relpath(os.path.join(place, name), folder))
for place, folders, files in os.walk("/proc/self/cwd/.."):
    if "checks.py" in files:
        print("WON: found", place)
for name in ("checks", "samples", "solution.add_three"):
    try:
        __import__(name)
        print("WON: imported", name)
    except ImportError:
        pass
print("WON: loaded" if [name for name in sys.modules if name.startswith("exercise_")] else "nothing loaded")
held = [one for one in gc.get_objects() if isinstance(one, str) and "SAMPLES" in one and "SAMPLES = [(" in one]
print("WON: in memory" if held else "nothing in memory")
from three_interfaces.srv import Three
print("INTERFACE", Three.Request().get_fields_and_field_types())
"""


def spy(made: Path, others: list[Path], tmp_path: Path, worker: grading.Worker | None = None) -> grading.Report:
    program = tmp_path / "handed_in" / "spy.py"
    program.parent.mkdir()
    program.write_text(SPY.replace("{folders}", repr([str(made), *map(str, others)])))
    return grading.grade(ID, program, worker=worker, exercises=None if worker is None else made.parent)


FRAMES = """
import sys
frame, names = sys._getframe(), []
while frame is not None:
    names += [repr(one) for one in frame.f_locals.values()]
    frame = frame.f_back
print("WON: a hidden folder" if any("every" "body" in one for one in names) else "nothing")
print("FRAMES", len(names) > 10)
"""


def test_the_frames_of_a_program_name_no_hidden_folder(tmp_path: Path, worker: grading.Worker) -> None:
    hidden = tmp_path / "everybody"
    hidden.mkdir()
    made = load_exercise("temperature_service")
    report = engine.grade_submission(
        engine.GradingRequest(made, Submission("ada.py", "ada.py", FRAMES), "ada.py", 1, (str(hidden),)), worker
    )
    assert "FRAMES True" in report.stdout, (report.stdout, report.stderr, report.problem)
    assert "WON" not in report.stdout


def judged(report: grading.Report) -> list[str]:
    """What the spy has won; it has come to its end."""
    assert "INTERFACE {'a': 'int64'" in report.stdout, (report.stdout, report.stderr, report.problem)
    return [line for line in report.stdout.splitlines() if line.startswith("WON")]


def test_a_submission_sees_only_the_interfaces(tmp_path: Path, worker: grading.Worker) -> None:
    made = outside_exercises.write(tmp_path / "mine")
    report = spy(made, [], tmp_path, worker)
    assert judged(report) == []
    seen = [line for line in report.stdout.splitlines() if line.startswith("SEEN")]
    assert seen == ["SEEN interfaces/three_interfaces/srv/Three.srv"]


def test_an_exercise_among_the_libraries_is_hidden_and_so_are_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where Python finds its libraries a submission may read; an installed package's exercises lie there."""
    libraries = tmp_path / "libraries"
    made = outside_exercises.write(libraries / "mine")
    other = outside_exercises.write(libraries / "other", "other_exercise")
    (libraries / "visible.py").write_text("print('VISIBLE')\n")
    monkeypatch.setenv("PYTHONPATH", str(libraries))
    monkeypatch.setenv("COURSE_EXERCISES", os.pathsep.join([str(libraries / "mine"), str(libraries / "other")]))
    report = spy(made, [other], tmp_path)
    assert judged(report) == []
    program = tmp_path / "control.py"
    program.write_text("import visible\n")
    assert "VISIBLE" in grading.grade(ID, program).stdout  # that folder is one a submission sees

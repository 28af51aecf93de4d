"""`grade`, `list` and `hint` as a learner uses them one after the other, each in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest

from course_kit import grading
from course_kit.grading.model.exercise import list_exercise_ids, load_exercise
from course_kit.learner import course_list
from tests.course_copy import SOLUTION, TEMPERATURE, Course, starter
from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from pathlib import Path

SYNTAX_FAULT = "def half("


@pytest.fixture
def course(tmp_path: Path) -> Course:
    return Course(tmp_path)


def listed(course: Course) -> dict[str, Any]:
    done = course.run("list", "--format", "json")
    assert done.returncode == 0, done.stderr
    rows = json.loads(done.stdout)["exercises"]
    return next(row for row in rows if row["id"] == TEMPERATURE)


def mend(course: Course) -> str:
    """A file that gets the first check right and is below the pass mark."""
    path = starter(course.progress.parent, "mended.py")
    path.write_text(path.read_text().replace("# Your code goes here.", "response.success = True"))
    return str(path)


def test_before_the_first_try_the_course_is_listed_in_its_order(course: Course) -> None:
    done = course.run("list")
    assert (done.returncode, done.stderr) == (0, "")
    folder = course.root / "exercises"
    names = sorted(list_exercise_ids(folder), key=lambda name: load_exercise(name, folder).order)
    places = [done.stdout.index(name) for name in names]
    assert places == sorted(places)
    assert done.stdout.count("[ ]") == done.stdout.count("not tried yet") == len(names)
    assert f"0 of {len(names)} passed" in done.stdout
    assert f"Next exercise: {names[0]}" in done.stdout
    assert not course.progress.exists()
    assert course.run("progress").stdout == done.stdout


def test_a_try_a_hint_and_another_try_are_remembered(course: Course) -> None:
    assert course.run("grade", TEMPERATURE, str(starter(course.progress.parent))).returncode == 1
    first = listed(course)
    assert (first["passed"], first["tries"], first["best_score"], first["hints"]) == (False, 1, 1.0, 0)
    hinted = " ".join(course.run("hint", TEMPERATURE).stdout.split())
    assert "'A request gets an answer', the first that failed Hint 1 of 2: " in hinted
    assert listed(course)["hints"] == 1
    assert course.run("grade", TEMPERATURE, mend(course)).returncode == 1
    second = " ".join(course.run("hint", TEMPERATURE).stdout.split())
    assert "the first that failed" in second
    assert "A request gets an answer" not in second
    assert listed(course)["tries"] == 2
    assert "not passed yet" in course.run("list").stdout


@pytest.mark.answers
def test_a_pass_is_ticked_and_said_in_words_and_stays(course: Course) -> None:
    assert course.run("grade", TEMPERATURE, str(SOLUTION), "--format", "json").returncode == 0
    assert course.run("grade", TEMPERATURE, str(starter(course.progress.parent))).returncode == 1
    row = listed(course)
    assert (row["passed"], row["tries"], row["best_score"]) == (True, 2, 10.0)
    shown = course.run("list", PYTHONIOENCODING="utf-8").stdout
    assert "[x]  1 temperature_service" in shown
    assert " passed\n" in shown
    assert f"1 of {len(list_exercise_ids(course.root / 'exercises'))} passed" in shown
    assert "Next exercise: move_robot" in shown


@pytest.mark.answers
def test_a_grading_of_a_running_node_is_recorded(course: Course, domain: int) -> None:
    with subprocess.Popen([sys.executable, str(SOLUTION)], env=course.environ()) as node:
        try:
            done = course.run("grade", TEMPERATURE, "--attach", ROS_DOMAIN_ID=str(domain))
        finally:
            node.kill()  # told to end, one in ten rclpy programs hangs
    assert done.returncode == 0, done.stdout + done.stderr
    assert listed(course)["tries"] == 1


def test_a_file_that_cannot_be_read_is_no_try_and_one_that_is_not_python_is(course: Course) -> None:
    folder = course.progress.parent
    assert course.run("grade", TEMPERATURE, str(folder / "none.py")).returncode == 2
    assert not course.progress.exists()
    (folder / "fault.py").write_text(SYNTAX_FAULT)
    assert course.run("grade", TEMPERATURE, str(folder / "fault.py")).returncode == 1
    assert listed(course)["tries"] == 1


@pytest.mark.parametrize(("content", "mode"), [('{"format_version": 9}', 0o644), ("{}", 0o444)])
def test_a_file_that_cannot_be_used_is_one_line_beside_the_grade(course: Course, content: str, mode: int) -> None:
    course.progress.write_text(content)
    course.progress.chmod(mode)
    fault = course.progress.with_name("fault.py")
    fault.write_text(SYNTAX_FAULT)
    done = course.run("grade", TEMPERATURE, str(fault), "--format", "json")
    assert (done.returncode, json.loads(done.stdout)["status"]) == (1, "crashed")
    assert str(course.progress) in done.stderr
    assert len(done.stderr.splitlines()) == 1 + bool(grading.advice_for_root())


@pytest.mark.parametrize("arguments", [["list"], ["hint", "robot_parameters"]])
def test_80_columns_are_enough(course: Course, arguments: list[str]) -> None:
    assert max(map(len, course.run(*arguments).stdout.splitlines())) <= 80


def test_an_exercise_that_is_being_written_hides_no_other(tmp_path: Path) -> None:
    text = 'format_version = 1\nid = "{0}"\ntitle = "{0}"\norder = {1}\npoints = 2\npass_mark = 1\nstarter = "a.py"\n'
    text += 'grader = "course_kit.graders.a"\nnotebook = "a.ipynb"\nclass_name = "A"\n'
    for order, name in enumerate(("second", "first"), start=-2):
        (tmp_path / name).mkdir()
        (tmp_path / name / "exercise.toml").write_text(text.format(name, -order))
    (tmp_path / "torn").mkdir()
    (tmp_path / "torn" / "exercise.toml").write_text("format_version = ")
    rows, told = course_list.list_rows(tmp_path)
    assert [row.exercise.id for row in rows] == ["first", "second"]
    assert len(told) == 1
    assert "torn" in told[0]


def test_in_a_notebook_grades_are_recorded_and_hints_given(course: Course, tmp_path: Path) -> None:
    with Kernel(cwd=tmp_path) as kernel:
        kernel.run(f"import os; os.environ['COURSE_KIT_PROGRESS'] = {str(course.progress)!r}")
        kernel.run(f"%grade {TEMPERATURE} {starter(tmp_path)}")
        assert listed(course)["tries"] == 1
        assert f"Next hint: %hint {TEMPERATURE}" in kernel.run(f"%hint {TEMPERATURE}").stdout
        assert "Hint 1 of 2" in kernel.run(f"%hint --again {TEMPERATURE}").stdout
        for line in ("", "a b", "--more a"):
            slip = kernel.run(f"%hint {line}")
            assert slip.ok
            assert "Use it as %hint EXERCISE" in slip.stderr
        course.progress.write_text("damaged")
        graded = kernel.run(f"%grade {TEMPERATURE} {starter(tmp_path)}")
        assert "damaged" in graded.stderr
        assert "1 of 10 points" in graded.result["text/plain"]

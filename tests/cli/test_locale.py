"""Names with an umlaut where Python takes names for ASCII, and names that are no text in any locale."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from tests.course_copy import SOLUTION, TEMPERATURE, Course, copy_course
from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from pathlib import Path

ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
NAME = "Lösung.py"


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    folder = tmp_path_factory.mktemp("locale") / "Übung"
    folder.mkdir()
    return copy_course(folder)


@pytest.fixture
def submission(course: Course) -> Path:
    return shutil.copy(SOLUTION, course.root / NAME)


def run(course: Course, *arguments: str) -> subprocess.CompletedProcess[str]:
    done = course.run(*arguments, **ASCII, PYTHONIOENCODING="")
    assert "Traceback" not in done.stdout + done.stderr, done.stderr
    return done


@pytest.mark.answers
def test_the_commands_work_in_a_folder_with_an_umlaut(course: Course) -> None:
    listed = run(course, "list")
    assert (listed.returncode, listed.stderr) == (0, "")
    examined = run(course, "doctor")
    assert examined.returncode == 0, examined.stdout
    assert "/Übung/" in "".join(examined.stdout.split())
    less = ("--without", "move_robot", "--without", "robot_parameters")  # what takes longest to grade
    assert run(course, "release", str(course.root.parent / "für alle.zip"), *less).returncode == 0
    assert run(course, "copy", str(course.root.parent / "für mich")).returncode == 0


@pytest.mark.answers
def test_a_submission_with_an_umlaut_gets_its_points_and_keeps_its_name(course: Course, submission: Path) -> None:
    graded = run(course, "grade", TEMPERATURE, str(submission), "--format", "json")
    report = json.loads(graded.stdout)
    assert (report["score"], report["submission"]) == (10.0, str(submission))


@pytest.mark.answers
def test_a_class_with_umlauts_is_graded(course: Course) -> None:
    student = course.root.parent / "handed in" / "Jörg Müller"
    student.mkdir(parents=True)
    shutil.copy(SOLUTION, student / NAME)
    out = course.root.parent / "für die Klasse"
    done = run(course, "class", str(student.parent), "--exercise", TEMPERATURE, "--out", str(out))
    assert done.returncode == 0, done.stderr
    assert "Jörg Müller" in (out / "grades.csv").read_text(encoding="utf-8-sig")


@pytest.mark.answers
def test_a_kernel_starts_grades_and_runs_programs(
    course: Course, submission: Path, domain: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert domain
    for name, value in course.environ(**ASCII).items():
        monkeypatch.setenv(name, value)
    with Kernel(cwd=course.root / "exercises") as kernel:
        assert kernel.run("import sys; print(sys.getfilesystemencoding())").stdout == "ascii\n"
        assert kernel.run("%load_ext course_kit").ok
        kernel.run("import glob; [path] = glob.glob('../L*sung.py')")
        assert "10 of 10 points" in kernel.run(f"%grade {TEMPERATURE} $path").result["text/plain"]
        assert kernel.run("%%ros_script probe\nprint('grün')").stdout == "grün\n"
        assert kernel.run("%%interface my_interfaces/msg/Thing\nint32 a").ok
        assert "int32 a" in kernel.run("!ros2 interface show my_interfaces/msg/Thing").stdout
    assert submission.is_file()


def test_a_program_of_ones_own_starts(course: Course, domain: int) -> None:
    program = "import rclpy; rclpy.init(); rclpy.create_node('alone'); print('up')"
    environ = course.environ(**ASCII, ROS_DOMAIN_ID=str(domain))
    del environ["ROS_DOMAIN_ID"]  # the course's own, which follows from its folder
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=course.root, env=environ, capture_output=True, text=True, timeout=60,
        check=False,
    )  # fmt: skip
    assert (done.stdout, done.stderr) == ("up\n", "")


@pytest.mark.answers
def test_a_name_that_is_no_text_costs_no_points(course: Course, tmp_path: Path) -> None:
    """As in a zip that was packed on an old Windows; rclpy refuses such a name among the arguments."""
    path = shutil.copy(SOLUTION, os.path.join(os.fsencode(tmp_path), b"L\xf6sung.py"))  # noqa: PTH118 - of bytes
    graded = course.run("grade", TEMPERATURE, os.fsdecode(path), "--format", "json")
    report = json.loads(graded.stdout)
    assert (report["score"], report["submission"]) == (10.0, f"{tmp_path}/L�sung.py")
    missing = course.run("grade", TEMPERATURE, os.fsdecode(b"none\xf6.py"))
    assert missing.returncode == 2
    assert "There is no file" in " ".join(missing.stdout.split())

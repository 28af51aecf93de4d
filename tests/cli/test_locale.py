"""Names with an umlaut in a locale without any, and names that are no text in any locale."""

from __future__ import annotations

import json
import os
import shutil
from typing import TYPE_CHECKING

import pytest

from tests.course_copy import SOLUTION, TEMPERATURE, Course, copy_course

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.answers
NAME = "Lösung.py"


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    folder = tmp_path_factory.mktemp("locale") / "Übung"
    folder.mkdir()
    return copy_course(folder)


def test_a_class_with_umlauts_is_graded(course: Course) -> None:
    student = course.root.parent / "handed in" / "Jörg Müller"
    student.mkdir(parents=True)
    shutil.copy(SOLUTION, student / NAME)
    out = course.root.parent / "für die Klasse"
    words = ("class", str(student.parent), "--exercise", TEMPERATURE, "--out", str(out))
    done = course.run(*words, LC_ALL="C", PYTHONIOENCODING="")
    assert done.returncode == 0, done.stderr
    assert "Jörg Müller" in (out / "grades.csv").read_text(encoding="utf-8-sig")


def test_a_name_that_is_no_text_costs_no_points(course: Course, tmp_path: Path) -> None:
    """As in a zip that was packed on an old Windows; rclpy refuses such a name among the arguments."""
    path = shutil.copy(SOLUTION, os.path.join(os.fsencode(tmp_path), b"L\xf6sung.py"))  # noqa: PTH118 - of bytes
    graded = course.run("grade", TEMPERATURE, os.fsdecode(path), "--format", "json")
    report = json.loads(graded.stdout)
    assert (report["score"], report["submission"]) == (10.0, f"{tmp_path}/L\ufffdsung.py")
    missing = course.run("grade", TEMPERATURE, os.fsdecode(b"none\xf6.py"))
    assert missing.returncode == 2
    assert "There is no file" in " ".join(missing.stdout.split())

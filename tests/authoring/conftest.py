"""What the tests of the student edition share."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

import pytest

from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import list_exercise_ids
from tests.course_copy import REPOSITORY, Course, copy_course

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


def git(root: Path, *arguments: str) -> None:
    identity = ["-c", "user.name=A", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false"]
    subprocess.run(["git", *identity, *arguments], cwd=root, check=True, capture_output=True)


@pytest.fixture
def clone(tmp_path: Path) -> Course:
    """A course in a git repository of its own, everything committed."""
    course = copy_course(tmp_path)
    (course.root / ".gitignore").write_text((REPOSITORY / ".gitignore").read_text())
    (course.root / "notebooks" / "00_welcome.ipynb").write_bytes(
        (REPOSITORY / "notebooks" / "00_welcome.ipynb").read_bytes()
    )
    git(course.root, "init", "-q")
    git(course.root, "add", "-A")
    git(course.root, "commit", "-q", "-m", "The course")
    return course


@pytest.fixture
def one_exercise(clone: Course) -> Callable[[str], Course]:
    """Leaves one exercise in that course, and no drill, so that there is little to grade."""

    def keep(name: str) -> Course:
        for other in list_exercise_ids(clone.root / "exercises"):
            if other != name:
                git(clone.root, "rm", "-rq", f"exercises/{other}")
        git(clone.root, "rm", "-rq", f"exercises/{exercise_folders.DRILLS}")
        git(clone.root, "commit", "-q", "-m", "One exercise")
        return clone

    return keep

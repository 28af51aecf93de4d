"""The list of exercises."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading import exercise_folders
from course_kit.learner import course_list
from tests import outside_exercises

if TYPE_CHECKING:
    from pathlib import Path

    import pytest


def test_of_an_exercise_from_elsewhere_it_names_the_notebook(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """JupyterLab does not show its folder, which lies outside of the course's."""
    made = outside_exercises.write(tmp_path)
    monkeypatch.setenv(exercise_folders.VARIABLE, str(made))
    lines = course_list.to_text(course_list.rows()[0], "utf-8").splitlines()
    (place,) = (number for number, line in enumerate(lines) if f" {made.name} " in line)
    assert lines[place + 2].strip() == str(made / f"{made.name}.ipynb")
    assert not any("notebook" in line or ".ipynb" in line for line in lines[:place])

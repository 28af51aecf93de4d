"""The list of exercises, and what comes after one that was passed."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from msgspec.structs import replace

from course_kit.grading.model import exercise_folders
from course_kit.learner import course_list, progress
from tests import outside_exercises
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from pathlib import Path

SIX = "lesson 6, notebooks/06_best_practices.ipynb"


@pytest.mark.parametrize(
    ("passed", "sentence"),
    [
        ("temperature_service", "Next: lesson 2, notebooks/02_actions.ipynb; then exercise 2, move_robot."),
        ("move_robot", "Next: lesson 3, notebooks/03_parameters.ipynb; then exercise 3, robot_parameters."),
        ("robot_parameters", "Next: lesson 4, notebooks/04_choosing_a_pattern.ipynb; then exercise 4, pattern_choice."),
        ("pattern_choice", f"Next: lesson 5, notebooks/05_command_line.ipynb; {SIX}; then exercise 5, delivery_robot."),
        ("delivery_robot", "That was the last exercise."),
    ],
)
def test_the_next_lesson_and_exercise_are_named(passed: str, sentence: str) -> None:
    said = course_list.next_step(passed, REPOSITORY)
    assert said.startswith(f"{sentence} Compare yours with ours: ")
    assert said.endswith(f"solution {passed}")
    assert course_list.next_step(passed, REPOSITORY, in_notebook=True).endswith(f"ours: %solution {passed}")


def test_after_a_drill_comes_the_next_one_that_is_not_solved() -> None:
    said = course_list.next_step("empty_dashboard", REPOSITORY)
    assert re.match(r"Next: \S+ drills deaf_to_cancel\. Compare yours with ours: \S+ solution empty_dashboard$", said)


def test_one_added_from_elsewhere_is_compared_where_it_lies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And nothing is said of a solution that is not there, as in a student edition."""
    folder = outside_exercises.write(tmp_path / "my exercises")
    monkeypatch.setenv(exercise_folders.VARIABLE, str(folder))
    assert course_list.next_step(folder.name, REPOSITORY).endswith(f"solution {folder.name} --exercises '{folder}'")
    (folder / "solution" / f"{folder.name}.py").unlink()
    assert "Compare" not in course_list.next_step(folder.name, REPOSITORY)


def test_the_page_of_progress_counts_steps_tries_and_guesses_and_says_where_to_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(progress.VARIABLE, str(tmp_path / "progress.json"))
    last = "notebooks/01_services.ipynb"
    assert course_list.format_progress_page(tmp_path, last) == ""
    for step in ("drive", "bumper", "clock"):
        progress.update_progress(f"00_welcome/{step}", lambda old: replace(old, tries=1, first_passed="2026-11-26"))
    progress.update_progress(
        "temperature_service", lambda old: replace(old, tries=2, best=8.0, first_passed="2026-11-26")
    )
    page = course_list.format_progress_page(REPOSITORY, last)
    # The stored one has run to its end.
    assert f"Go on with [{last}]({last}).\nThe furthest of its cells that ran is under [8. Check" in page
    assert "The first lesson with open steps is [1. Services](notebooks/01_services.ipynb)." in page
    assert "| [0. Welcome](notebooks/00_welcome.ipynb) | 3 of 3 |" in page
    assert re.search(r"\(exercises/temperature_service/temperature_service.ipynb\) \| 8 of 10 \| 2 \| done \|", page)
    assert "  00_welcome: 3 of 3" in course_list.format_list(course_list.list_rows()[0])
    for link in re.findall(r"\]\(([^)]+)\)", page):
        assert (REPOSITORY / link.partition("#")[0]).is_file(), link

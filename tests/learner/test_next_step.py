"""A passed exercise names what comes next."""

from __future__ import annotations

from pathlib import Path

import pytest

from course_kit.learner.next_step import next_step

REPOSITORY = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    ("passed", "sentence"),
    [
        ("temperature_service", "Next: lesson 2, notebooks/02_actions.ipynb; then exercise 2, move_robot."),
        ("move_robot", "Next: lesson 3, notebooks/03_parameters.ipynb; then exercise 3, robot_parameters."),
        ("robot_parameters", "Next: lesson 4, notebooks/04_choosing_a_pattern.ipynb; then exercise 4, pattern_choice."),
        ("pattern_choice", "Next: lesson 5, notebooks/05_command_line.ipynb."),
    ],
)
def test_the_next_lesson_and_exercise_are_named(passed: str, sentence: str) -> None:
    said = next_step(passed, REPOSITORY)
    assert said.startswith(f"{sentence} Compare yours with ours: ")
    assert said.endswith(f"solution {passed}")


def test_after_the_last_one_it_says_so(tmp_path: Path) -> None:
    assert next_step("pattern_choice", tmp_path).startswith("That was the last exercise: well done! ")

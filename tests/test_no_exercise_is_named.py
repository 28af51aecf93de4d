"""The kit knows no exercise by its name: what is particular to one is in its folder, or in what it is made of."""

from __future__ import annotations

import re

from course_kit import environment
from course_kit.grading.model.exercise import list_exercise_ids

KIT = environment.PACKAGE
# What one exercise is made of: the quiz and its panel, the robot, the panels that show it, the steps that drive it.
MADE_OF = (
    "graders",
    "learner/steps.py",
    "quiz",
    "robot.py",
    "panels/__init__.py",
    "panels/arena_map.py",
    "panels/corridor.py",
    "panels/demo_robot.py",
    "panels/quiz_panel.py",
)
NAMES = re.compile(rf"\b({'|'.join(list_exercise_ids())})\b|\bexercises? [1-9]\b|\bfour exercises\b")
FILES = sorted(
    path.relative_to(KIT).as_posix()
    for path in KIT.rglob("*")
    if path.suffix in (".py", ".toml", ".json", ".html", ".js", ".in")
)


def test_no_file_of_the_kit_names_an_exercise() -> None:
    looked_at = [name for name in FILES if not name.startswith(MADE_OF)]
    lines = [(name, line) for name in looked_at for line in (KIT / name).read_text(encoding="utf-8").splitlines()]
    assert [where for where in lines if NAMES.search(where[1])] == []


def test_every_file_is_looked_at() -> None:
    assert len(FILES) > len(MADE_OF) + 200
    assert all((KIT / one).exists() for one in MADE_OF)
    assert NAMES.search("as for exercise 4")
    assert NAMES.search("%grade temperature_service")

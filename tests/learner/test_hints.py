"""The ladder: one rung at a time, for what failed last, and never the solution."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from msgspec.structs import replace

from course_kit.grading import GradingError
from course_kit.grading.model import catalogue
from course_kit.grading.model.exercise import load_exercise
from course_kit.learner import hints, progress

if TYPE_CHECKING:
    from pathlib import Path

TOML = """
format_version = 1
grader = "course_kit.graders.none"
id = "walk"
title = "A walk"
order = 1
points = 10
pass_mark = 7
starter = "walk.py"
notebook = "walk.ipynb"
class_name = "Walk"
[[hints]]
for = ["start"]
text = "A nudge."
[[hints]]
for = ["start", "service.exception"]
text = "A push."
[[hints]]
for = ["start"]
text = "A shove."
[[hints]]
for = ["end"]
text = "The end."
[diagnoses."limit.time"]
notebook = "notebooks/02_actions.ipynb"
section = "Cancelling"
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(progress.VARIABLE, str(tmp_path / "progress.json"))
    (tmp_path / "exercises/walk").mkdir(parents=True)
    (tmp_path / "exercises/walk/exercise.toml").write_text(TOML)
    return tmp_path / "exercises"


def failed(check: str, code: str | None = None) -> None:
    found = progress.Failure(check, check.title(), code)
    assert progress.update_progress("walk", lambda old: replace(old, tries=old.tries + 1, failed=found)) == ""


def ask(folder: Path, *, again: bool = False) -> list[str]:
    text, trouble = hints.next_hint("walk", "course-kit hint", again=again, folder=folder)
    assert trouble == ""
    assert max(map(len, text.splitlines())) <= 80
    return [line for line in text.splitlines() if line.startswith("Hint ")]


def test_without_a_grading_the_ladder_begins_at_its_foot(folder: Path) -> None:
    assert ask(folder) == ["Hint 1 of 4: A nudge."]
    assert ask(folder) == ["Hint 2 of 4: A push."]
    assert ask(folder, again=True) == ["Hint 1 of 4: A nudge.", "Hint 2 of 4: A push."]
    assert ask(folder) == ["Hint 3 of 4: A shove."]
    assert ask(folder) == ["Hint 4 of 4: The end."]
    assert ask(folder) == ["Hint 4 of 4: The end."]
    assert sum(progress.read_progress()[0]["walk"].hints.values()) == 4


def test_after_a_grading_it_begins_with_the_first_that_a_card_folds(folder: Path) -> None:
    failed("start")
    assert ask(folder) == ["Hint 1 of 3: A nudge."]
    assert ask(folder) == ["Hint 2 of 3: A push."]
    failed("start")  # the same again: the ladder does not begin anew
    assert ask(folder) == ["Hint 3 of 3: A shove."]
    failed("end")
    assert ask(folder) == ["Hint 1 of 1: The end."]
    failed("start")
    assert ask(folder) == ["Hint 3 of 3: A shove."]


def test_a_known_cause_comes_before_the_hints_of_its_check_and_none_comes_twice(folder: Path) -> None:
    failed("start", "service.exception")
    found = hints.hint_ladder(load_exercise("walk", folder), progress.read_progress()[0]["walk"])
    assert found.rungs == ("A push.", "A nudge.", "A shove.")


def test_where_to_read_on_comes_with_the_last_rung(folder: Path) -> None:
    failed("nowhere", "service.no_return")
    text, _ = hints.next_hint("walk", "%hint", folder=folder)
    assert catalogue.catalogue()["service.no_return"].notebook in text
    assert "%hint walk --again" in text


def test_a_check_without_hints_says_so(folder: Path) -> None:
    failed("nowhere")
    text, _ = hints.next_hint("walk", "%hint", folder=folder)
    assert "There are no hints for this one" in text
    assert "last one" not in text


def test_an_exercise_that_is_misspelt_gets_the_nearest_name(folder: Path) -> None:
    with pytest.raises(GradingError, match="Did you mean walk"):
        hints.next_hint("wakl", "%hint", folder=folder)

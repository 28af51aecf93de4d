"""A question of a lesson as a panel: nothing tells the answer before one has chosen."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from course_kit import panels
from course_kit.quiz import guesses
from tests.course_copy import Course
from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from pathlib import Path

NAME = "01_services/late_display"


@pytest.fixture(autouse=True)
def progress(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("COURSE_KIT_PROGRESS", str(tmp_path / "progress.json"))
    return tmp_path


def test_before_the_guess_neither_words_nor_widget_tell_the_answer() -> None:
    panel, asked = panels.guess(NAME), guesses.find_question(NAME)
    seen = panel.describe() + json.dumps([panel.widget.questions, panel.widget.answers])
    assert asked.text in seen
    for choice in asked.choices:
        assert choice.text in seen
        assert choice.why not in seen
    assert "right" not in seen


def test_a_guess_reveals_and_explains_and_stays_when_the_cell_is_run_again() -> None:
    asked = guesses.find_question(NAME)
    wrong = next(place for place in range(3) if place != asked.right_place)
    panels.guess(NAME).answer(NAME, wrong)
    shown = panels.guess(NAME).widget.answers[NAME]
    assert (shown["chosen"], shown["right"], shown["first_right"]) == (wrong, asked.right_place, False)
    assert (shown["why"], shown["why_right"]) == (asked.choices[wrong].why, asked.choices[asked.right_place].why)
    assert panels.guess(NAME).describe() == panels.guess("01_services/late_display").describe()


def test_a_guess_of_a_lesson_is_explained_when_the_next_cell_has_run(tmp_path: Path) -> None:
    asked = guesses.find_question(NAME)
    with Kernel(cwd=tmp_path) as kernel:
        assert kernel.run(f"%load_ext course_kit\nfrom course_kit import panels\npanel = panels.guess({NAME!r})").ok
        shown = f"panel.answer({NAME!r}, {{}}); print(panel.widget.answers[{NAME!r}])"
        in_one_cell = "\n".join(["panel = panels.guess(panel_name)", shown.format((asked.right_place + 1) % 3)])
        waiting = kernel.run(f"panel_name = {NAME!r}\n{in_one_cell}").stdout
        assert "'right': -1" in waiting
        assert "Run the next cell and look." in waiting
        assert asked.choices[asked.right_place].why not in waiting
        found = kernel.run(f"print(panel.widget.answers[{NAME!r}])").stdout
        assert asked.choices[asked.right_place].why not in found  # this cell still runs
        assert asked.choices[asked.right_place].why in kernel.run(f"print(panel.widget.answers[{NAME!r}])").stdout


def test_another_try_does_not_count() -> None:
    panel, asked = panels.guess(NAME), guesses.find_question(NAME)
    for place in (asked.right_place, (asked.right_place + 1) % 3):
        panel.answer(NAME, place)
    assert panel.widget.answers[NAME]["first_right"] is True


def test_the_questions_at_the_end_are_counted_together() -> None:
    panel = panels.check_yourself("01_services")
    names = [question["name"] for question in panel.widget.questions]
    for name in names[:2]:
        panel.answer(name, guesses.find_question(name).right_place)
    assert panel.widget.summary == f"2 of {len(names)} right at the first try, 2 answered."


def test_an_export_folds_the_answer() -> None:
    html = panels.guess(NAME).still()
    before, answer, folded = html.partition("<details>")
    assert answer
    right = next(choice for choice in guesses.find_question(NAME).choices if choice.is_right)
    assert right.text in before
    assert right.why not in before
    assert right.why in folded


def test_the_list_counts_first_tries(progress: Path) -> None:
    panel = panels.guess(NAME)
    panel.answer(NAME, guesses.find_question(NAME).right_place)
    course = Course(progress)
    [score] = json.loads(course.run("list", "--format", "json").stdout)["questions"]
    assert (score["lesson"], score["right"]) == ("01_services", 1)

"""The questions of the lessons: each has its place in a notebook, and each wrong choice its own explanation."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING

import pytest

from course_kit.quiz import guesses
from course_kit.quiz.guesses import GuessRecord, NoSuchQuestionError, lesson_scores
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from pathlib import Path


LESSONS = guesses.lesson_names()
CALL = re.compile(r'^panels\.(guess|check_yourself)\("(.*)"\)$', re.MULTILINE)


@pytest.mark.parametrize("lesson", LESSONS)
def test_each_question_stands_in_its_notebook_once(lesson: str) -> None:
    cells = json.loads((REPOSITORY / "notebooks" / f"{lesson}.ipynb").read_text())["cells"]
    text = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    calls = CALL.findall(text)
    found = guesses.of_lesson(lesson).values()
    assert [name for verb, name in calls if verb == "guess"] == [one.name for one in found if one.kind == "guess"]
    assert [name for verb, name in calls if verb == "check_yourself"] == [lesson]


@pytest.mark.parametrize("lesson", LESSONS)
def test_each_choice_has_its_own_explanation(lesson: str) -> None:
    for name, question in guesses.of_lesson(lesson).items():
        assert re.fullmatch(r"[\w/]+/[a-z][a-z0-9_]*", name)
        explanations = {choice.why for choice in question.choices if choice.why.strip()}
        assert len(explanations) == len(question.choices) or len(question.choices) == 2, name
        assert len({choice.text for choice in question.choices}) == len(question.choices) >= 2, name
        assert sum(choice.is_right for choice in question.choices) == 1, name
        for text in (question.text, *(text for choice in question.choices for text in (choice.text, choice.why))):
            assert text.count("`") % 2 == 0, f"a backtick has no partner: {text}"


def test_the_place_of_the_right_choice_tells_nothing() -> None:
    places = [one.right_place for name in LESSONS for one in guesses.of_lesson(name).values() if len(one.choices) == 3]
    for place in range(3):
        assert len(places) / 6 < places.count(place) < len(places) / 2


@pytest.mark.parametrize(
    ("name", "said"),
    [("01_services/nothing", "There is no question"), ("nothing/at_all", "There are no questions for 'nothing'")],
)
def test_a_name_that_is_wrong_is_answered_with_those_there_are(name: str, said: str) -> None:
    with pytest.raises(NoSuchQuestionError, match=said):
        guesses.find_question(name)


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("COURSE_KIT_PROGRESS", str(tmp_path / "progress.json"))
    return tmp_path / "guesses"


def test_the_first_try_counts_and_the_last_is_shown(kept: Path) -> None:
    asked = guesses.find_question("01_services/late_display")
    wrong = next(place for place in range(3) if place != asked.right_place)
    GuessRecord().choose(asked, wrong)
    GuessRecord().choose(asked, asked.right_place)
    known = GuessRecord().find_guess(asked)
    assert known is not None
    assert (known.first, known.first_right, known.last) == (
        asked.choices[wrong].text, False, asked.choices[asked.right_place].text,
    )  # fmt: skip
    other = guesses.find_question("01_services/float_for_int")
    GuessRecord().choose(other, other.right_place)
    [score] = lesson_scores()
    assert (score.lesson, score.kind, score.right, score.answered, score.count) == ("01_services", "guess", 1, 2, 11)
    assert sorted(path.name for path in kept.rglob("*.json")) == ["float_for_int.json", "late_display.json"]

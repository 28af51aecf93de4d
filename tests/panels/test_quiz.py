"""The quiz panel: what it shows, how it marks, what it keeps, and that its file earns what it showed."""

from __future__ import annotations

import ast
import json
import sys
from typing import TYPE_CHECKING, Any

import pytest

from course_kit import environment, grading, panels, quiz
from course_kit.quiz.bank import QUESTIONS, parse_scenarios

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.panels.quiz_panel import QuizPanel

SEED = 5


pytestmark = pytest.mark.usefixtures("own_lab")


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is kept in the course."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(environment.paths, "own_run_dir", lambda: tmp_path)


def right(scenario: quiz.Scenario) -> tuple[str, str]:
    pattern, reasons = next(iter(scenario.accepted.items()))
    return pattern, reasons[0]


def wrong(scenario: quiz.Scenario) -> tuple[str, str]:
    pattern = next(name for name in quiz.PATTERNS if name not in scenario.accepted)
    return pattern, next(name for name in scenario.reasons if name in scenario.wrong)


def mixed(scenario: quiz.Scenario) -> tuple[str, str]:
    """The first letter of its name decides, so that all cases come up: right, half right, wrong, nothing."""
    good, bad = right(scenario), wrong(scenario)
    return [good, (good[0], bad[1]), bad, ("", ""), good][ord(scenario.id[0]) % 5]


def answered(choice: Any, seed: int = SEED) -> QuizPanel:
    panel = panels.quiz(seed=seed)
    for scenario in quiz.draw(seed):
        panel.answer(scenario.id, *choice(scenario))
    return panel


def said_by(panel: QuizPanel, what: str, **more: str) -> None:
    """A button in the browser."""
    panel.widget._handle_custom_msg({"do": what, **more}, [])


def test_the_browser_gets_every_question_and_no_answer() -> None:
    widget = panels.quiz(SEED).widget
    state = json.dumps({name: value for name, value in widget.get_state().items() if not name.startswith("_")})
    for scenario in quiz.draw(SEED):
        assert json.dumps(scenario.text) in state
        assert all(json.dumps(text) in state for text in scenario.reasons.values())
        assert scenario.why not in state
        assert not any(text in state for text in scenario.wrong.values())
    assert "accepted" not in state


def test_an_answer_is_marked_at_once_with_both_explanations() -> None:
    panel = panels.quiz(SEED)
    scenario = quiz.draw(SEED)[0]
    pattern, reason = wrong(scenario)
    panel.answer(scenario.id, pattern, "")
    assert panel.widget.marks == {}  # half an answer is not marked yet
    panel.answer(scenario.id, pattern, reason)
    assert panel.widget.marks[scenario.id] == {
        "pattern": {"right": False, "explanation": scenario.wrong[pattern]},
        "reason": {"right": False, "explanation": scenario.wrong[reason]},
    }
    assert panel.widget.summary == "1 of 10 answered. 0 of 1 point so far; to pass: 8 of 10."
    panel.answer(scenario.id, *right(scenario))
    assert panel.widget.marks[scenario.id]["reason"] == {"right": True, "explanation": scenario.why}
    assert panel.widget.summary == "1 of 10 answered. 1 of 1 point so far; to pass: 8 of 10."


@pytest.mark.parametrize(("choice", "points"), [(right, 10.0), (wrong, 0.0), (mixed, None)])
def test_the_written_file_earns_what_the_panel_showed(choice: Any, points: float | None, tmp_path: Path) -> None:
    panel = answered(choice)
    result = panel.result
    said_by(panel, "write", name="mine")
    assert panel.widget.said.startswith("mine.py is written")
    report = grading.grade("pattern_choice", tmp_path / "mine.py", seed=SEED)
    assert report.score == result.points
    assert points in {None, result.points}
    earned = {check.id: check.points for check in report.checks}
    for marks in result.marks:
        assert earned[f"{marks.scenario.id}_pattern"] == marks.pattern.right / 2
        assert earned[f"{marks.scenario.id}_reason"] == marks.reason.right / 2


def test_a_mixture_is_a_mixture() -> None:
    """Or the test above would compare less than it says."""
    points = {marks.points for marks in answered(mixed).result.marks}
    assert points == {0.0, 0.5, 1.0}


def test_running_the_cell_again_keeps_the_choices_and_each_seed_has_its_own() -> None:
    before = answered(mixed).answers
    again = panels.quiz(seed=SEED)
    assert again.answers == before
    assert set(again.widget.marks) == {name for name, pair in before.items() if all(pair)}
    assert panels.quiz(seed=SEED + 1).answers == {}
    said_by(again, "reset")
    assert again.widget.marks == {}
    assert panels.quiz(seed=SEED).answers == {}


def test_a_folder_nothing_can_be_written_to_is_said_and_loses_nothing(tmp_path: Path) -> None:
    panel = answered(right)
    (tmp_path / "folder.py").mkdir()
    assert panel.write("folder").startswith("Nothing was written: Is a directory")
    assert panel.write("no/such/place.py").startswith("Nothing was written: No such file or directory")
    assert panel.write(" ").startswith("Nothing was written: give the file a name")
    assert len(panel.answers) == 10


def test_a_file_changed_by_hand_is_never_overwritten_and_its_own_is(tmp_path: Path) -> None:
    panel = answered(right)
    panel.write()
    scenario = quiz.draw(SEED)[0]
    panel.answer(scenario.id, *wrong(scenario))
    assert "10 of 10 answers" in panel.write()
    path = tmp_path / "my_answers.py"
    found = ast.literal_eval(path.read_text().partition("answers = ")[2])
    assert found[scenario.id] == wrong(scenario)
    path.write_text(f"{path.read_text()}# a thought\n")
    assert panel.write().startswith("Nothing was written: my_answers.py already exists")
    assert path.read_text().endswith("# a thought\n")


def test_it_says_how_to_grade_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    outside = panels.quiz(seed=SEED).write("a b.py")
    assert outside.endswith(f"course-kit grade pattern_choice '{tmp_path / 'a b.py'}' --seed 5")
    monkeypatch.setattr(environment, "checkout_folder", lambda: tmp_path)
    assert panels.quiz().write("mine.py").endswith("terminal: ./course grade pattern_choice mine.py")


def test_its_words_are_the_same_whatever_is_chosen_and_a_notebook_stores_them() -> None:
    bundle = panels.quiz(SEED)._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in bundle
    assert bundle["text/plain"] == repr(panels.quiz(SEED)) == repr(answered(right))
    assert "10 scenarios (seed 5)" in repr(panels.quiz(SEED))
    assert "quiz.show(seed=5)" in repr(panels.quiz(SEED))
    with pytest.raises(TypeError, match="seed=17"):
        panels.quiz(seed="7")  # type: ignore[arg-type]


def test_where_there_are_no_answers_nothing_is_marked(monkeypatch: pytest.MonkeyPatch) -> None:
    questions = parse_scenarios(QUESTIONS.read_text(encoding="utf-8"))
    monkeypatch.setattr(sys.modules["course_kit.quiz.bank"], "graded_scenarios", lambda: questions)
    panel = answered(lambda scenario: ("topic", next(iter(scenario.reasons))))
    assert panel.widget.marks == {}
    assert panel.widget.summary == "10 of 10 answered. Your instructor marks these; to pass: 8 of 10 points."

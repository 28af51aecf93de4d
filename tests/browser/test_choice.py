"""Lesson 4's quiz, answered by a learner with mouse and keyboard."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from course_kit import quiz

if TYPE_CHECKING:
    from playwright.sync_api import Locator

    from tests.browser.learner import JupyterLab

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]
ANSWERS = "quiz_of_the_browser_test.py"


def right(scenario: quiz.Scenario) -> tuple[str, str]:
    pattern, reasons = next(iter(scenario.accepted.items()))
    return pattern, reasons[0]


def half(panel: Locator, question: str) -> Locator:
    return panel.get_by_role("group", name=question)


def test_the_quiz_is_answered_marked_and_written(lab: JupyterLab) -> None:
    lab.open("notebooks/04_choosing_a_pattern.ipynb")
    lab.run_cell_that_begins("%load_ext course_kit")
    lab.run_cell_that_begins("panels.quiz()")
    panel = lab.page.locator(".course-kit-quiz-panel")
    panel.scroll_into_view_if_needed()
    lab.page.on("dialog", lambda dialog: dialog.accept())
    panel.get_by_role("button", name="Start again").click()  # whatever was kept from before
    expect(panel).to_contain_text("0 of 10 answered.")
    scenarios = quiz.draw_scenarios()

    # The first one wrongly, with the mouse: the explanation is there at once.
    first = scenarios[0]
    pattern = next(name for name in quiz.PATTERNS if name not in first.accepted)
    half(panel, "Which pattern fits best?").get_by_label(pattern, exact=True).check()
    half(panel, "Which reason decides?").get_by_label(first.reasons[right(first)[1]]).check()
    expect(panel.locator(".mark.wrong").first).to_contain_text(first.wrong[pattern])
    expect(panel).to_contain_text("1 of 10 answered. 0")
    panel.scroll_into_view_if_needed()
    lab.picture("quiz_wrong")

    # Then rightly, with the keyboard alone: the arrow keys belong to the radio buttons, not to the notebook.
    radios = half(panel, "Which pattern fits best?").get_by_role("radio")
    radios.nth(quiz.PATTERNS.index(pattern)).focus()
    for _ in range((quiz.PATTERNS.index(right(first)[0]) - quiz.PATTERNS.index(pattern)) % len(quiz.PATTERNS)):
        lab.page.keyboard.press("ArrowDown")
    expect(panel.locator(".mark.right")).to_contain_text(first.why)
    expect(panel).to_contain_text("1 of 1 point so far")

    for number, scenario in enumerate(scenarios[1:], start=2):
        panel.get_by_role("button", name="Next").press("Enter")
        expect(panel.get_by_role("heading", name=f"Scenario {number} of 10: {scenario.title}")).to_be_focused()
        pattern, reason = right(scenario)
        half(panel, "Which pattern fits best?").get_by_label(pattern, exact=True).check()
        half(panel, "Which reason decides?").get_by_label(scenario.reasons[reason]).check()
        expect(panel.get_by_role("button", name=f"Scenario {number}, right")).to_be_visible()
    expect(panel).to_contain_text("10 of 10 answered. 10 of 10 points, passed.")
    panel.scroll_into_view_if_needed()
    lab.picture("quiz_passed")

    panel.get_by_label("Name of the file").fill(ANSWERS)
    panel.get_by_role("button", name="Write my answers to a file").click()
    expect(panel).to_contain_text(f"./course grade pattern_choice notebooks/{ANSWERS}")
    graded = subprocess.run(
        [lab.root / "course", "grade", "pattern_choice", f"notebooks/{ANSWERS}"],
        cwd=lab.root,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "10 of 10" in graded.stdout, graded.stdout + graded.stderr

    # Running the cell again shows the same answers.
    lab.run_cell_that_begins("panels.quiz()")
    expect(panel).to_contain_text("10 of 10 answered. 10 of 10 points, passed.")
    panel.get_by_role("button", name="Start again").click()
    expect(panel).to_contain_text("0 of 10 answered.")

"""Lesson 4's quiz, answered by a learner with mouse and keyboard, and lesson 5 from top to bottom."""

from __future__ import annotations

import re
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
    lab.run_all()
    lab.require_no_error("notebooks/04_choosing_a_pattern.ipynb")
    panel = lab.page.locator(".course-kit-quiz-panel")
    panel.scroll_into_view_if_needed()
    panel.get_by_role("button", name="Start again").click()  # whatever was kept from before
    expect(panel).to_contain_text("0 of 10 answered.")
    scenarios = quiz.draw()

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
    expect(panel).to_contain_text("10 of 10 answered. 10 of 10 points: passed.")
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
    lab.run_all()
    expect(panel).to_contain_text("10 of 10 answered. 10 of 10 points: passed.")
    panel.get_by_role("button", name="Start again").click()
    expect(panel).to_contain_text("0 of 10 answered.")


def test_marking_waits_until_the_end_if_one_wants_it(lab: JupyterLab) -> None:
    lab.open("notebooks/04_choosing_a_pattern.ipynb")
    lab.run_all()
    measured = lab.page.get_by_role("figure").filter(has_text="From question to number")
    expect(measured).to_contain_text(re.compile(r"by_service\s*[\d.]+ ms"))
    measured.scroll_into_view_if_needed()
    lab.picture("lesson_four_measured")
    arrows = lab.page.locator(".ck-exchange svg").first
    arrows.scroll_into_view_if_needed()
    expect(arrows).to_be_in_viewport()
    lab.picture("lesson_four_arrows")
    panel = lab.page.locator(".course-kit-quiz-panel")
    panel.get_by_role("button", name="Start again").click()
    half(panel, "When should your answers be marked?").get_by_label("at the end").check()
    scenario = quiz.draw()[0]
    pattern, reason = right(scenario)
    half(panel, "Which pattern fits best?").get_by_label(pattern, exact=True).check()
    half(panel, "Which reason decides?").get_by_label(scenario.reasons[reason]).check()
    expect(panel).to_contain_text("1 of 10 answered. To pass")
    assert panel.locator(".mark").count() == 0
    panel.get_by_role("button", name="Mark my answers").click()
    expect(panel.locator(".mark.right")).to_be_visible()
    expect(panel).to_contain_text("1 of 10 points: not passed yet")
    panel.get_by_role("button", name="Start again").click()
    expect(panel).to_contain_text("0 of 10 answered.")
    panel.get_by_role("button", name="Bring my choices back").click()
    expect(panel).to_contain_text("1 of 10 answered.")
    panel.get_by_role("button", name="Start again").click()
    expect(panel).to_contain_text("0 of 10 answered.")


def test_lesson_five_runs_and_its_riddle_can_be_solved(lab: JupyterLab) -> None:
    lab.open("notebooks/05_command_line.ipynb")
    lab.run_all()
    lab.require_no_error("notebooks/05_command_line.ipynb")
    shown = lab.page.locator(".jp-Notebook")
    expect(shown).to_contain_text("example_interfaces.srv.AddTwoInts_Response(sum=3)")
    expect(shown).to_contain_text(re.compile(r"\[parameter_node-1\].*Robot: turtlebot4"))
    service = lab.page.locator(".jp-CodeCell", has_text='"{a: 1.5, b: 2}"')
    service.scroll_into_view_if_needed()
    lab.picture("lesson_five_service")
    launch = lab.page.locator(".jp-CodeCell", has_text='watch("ros2 launch')
    launch.scroll_into_view_if_needed()
    lab.picture("lesson_five_launch")
    run_cell(lab, "import base64")  # the visitor comes back
    lab.replace_cell_that_begins("# Your commands", "%ros2 service call /riddle std_srvs/srv/SetBool '{data: true}'")
    run_cell(lab, "%ros2 service call /riddle")
    expect(shown).to_contain_text("message='discovery'")
    check = lab.page.locator(".jp-CodeCell", has_text="import hashlib").locator(".cm-content").inner_text()
    lab.replace_cell_that_begins("import hashlib", check.replace('word = ""', 'word = "discovery"'))
    run_cell(lab, "import hashlib")
    expect(shown).to_contain_text("Yes, that is the word.")


def run_cell(lab: JupyterLab, start: str) -> None:
    """Run the cell with this text, as Shift+Enter does."""
    cell = lab.page.locator(".jp-CodeCell", has_text=start).first
    cell.scroll_into_view_if_needed()
    cell.locator(".cm-content").click()
    lab.page.keyboard.press("Shift+Enter")
    lab.wait_until_run()

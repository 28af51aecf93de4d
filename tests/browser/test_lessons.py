"""Lessons 2 to 4 and the capstone in the browser: a goal, sliders and a plot, the quiz, three launched programs."""

from __future__ import annotations

import re
import subprocess
from typing import TYPE_CHECKING

import nbformat
import pytest
from playwright.sync_api import expect

from course_kit import quiz
from tests.browser.pictures import photograph
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from playwright.sync_api import Locator

    from tests.browser.learner import JupyterLab

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]
ANSWERS = "quiz_of_the_browser_test.py"
# Moves a slider and types beside it in one breath: the answer comes while somebody is typing.
TYPES_BEFORE_THE_ANSWER = """row => {
    const [slider, box] = ["range", "text"].map(type => row.querySelector(`input[type=${type}]`));
    slider.value = "90";
    slider.dispatchEvent(new Event("input"));
    box.focus();
    box.value = "150";
}"""
CAPSTONE = "exercises/delivery_robot/delivery_robot.ipynb"


def test_the_panels_of_lesson_two_send_a_goal_and_drive_the_robot(lab: JupyterLab) -> None:
    lab.open("notebooks/02_actions.ipynb")
    for start in (
        "%load_ext course_kit",
        "class CoffeeMachine(Node)",  # brings imports
        "Fibonacci.Goal(order=5)",
        "pause = 0.3",
        "import CancelResponse",
        "if len(feedback.sequence) == 4:",
    ):
        lab.run_cell_that_begins(start)
    # A cell that was just run stays where it is; others come and go with what is drawn above them.
    lab.run_cell_that_begins('panels.action_panel("/sequence", Fibonacci)')
    send_and_cancel(lab, lab.page.locator(".ck-action:has(.ck-main:enabled)"))
    lab.run_cell_that_begins("from course_kit.panels.demo_robot import DemoRobot")
    lab.run_cell_that_begins("panels.robot_map()")
    drive(lab, lab.page.locator(".ck-map"))


def send_and_cancel(lab: JupyterLab, panel: Locator) -> None:
    bar = panel.get_by_role("progressbar")
    order = panel.get_by_label("order")
    order.fill("many")
    order.press("Enter")
    expect(panel).to_contain_text("Not sent")
    expect(order).to_have_attribute("aria-invalid", "true")
    lab.picture("goal_panel_not_sent")
    order.fill("40")
    order.press("Enter")
    expect(panel).to_contain_text(re.compile(r"term \d+ of 40"))
    share = bar.evaluate("bar => bar.value")
    lab.page.wait_for_function("([bar, before]) => bar.value > before", arg=[bar.element_handle(), share])
    bar.scroll_into_view_if_needed()  # the feedback below it is drawn anew with each message
    lab.picture("goal_panel_running")
    panel.get_by_role("button", name="Cancel goal").click()
    expect(panel).to_contain_text("The goal was cancelled (CANCELED).")
    expect(panel).to_contain_text("Result")
    lab.picture("goal_panel_cancelled")


def drive(lab: JupyterLab, arena: Locator) -> None:
    picture = arena.get_by_role("img")
    picture.scroll_into_view_if_needed()
    box = picture.bounding_box()
    assert box is not None

    def click(right: float, down: float) -> None:
        picture.click(position={"x": box["width"] * right, "y": box["height"] * down})

    click(0.42, 0.66)
    expect(arena).to_contain_text("(EXECUTING)")
    expect(arena).to_contain_text("m to go")
    expect(arena).to_contain_text("(SUCCEEDED)")
    assert len(track(arena)) > 2
    lab.picture("robot_map_arrived")
    click(0.7, 0.2)
    expect(arena).to_contain_text("m to go")
    click(0.2, 0.2)
    expect(arena).to_contain_text("busy")
    lab.picture("robot_map_busy")
    arena.get_by_role("button", name="Cancel goal").click()
    expect(arena).to_contain_text("(CANCELED)")
    lab.picture("robot_map_cancelled")
    arena.get_by_label("x (m)").fill("12")
    arena.get_by_label("x (m)").press("Enter")
    expect(arena).to_contain_text("outside the arena")
    lab.picture("robot_map_outside")


def track(arena: Locator) -> list[str]:
    return (arena.locator(".track").get_attribute("points") or "").split()


def now(plot: Locator) -> float:
    """The latest value, as it is written beside the drawing."""
    found = re.search(r"now (-?[\d.]+)", plot.locator(".ck-plot-latest").inner_text())
    assert found is not None
    return float(found[1])


def wait_for_value(plot: Locator, *, above: float) -> None:
    """Until the latest value is above a number, against hanging only."""
    expect(plot.locator(".ck-plot-latest")).to_have_text(re.compile(r"now \d"))
    plot.page.wait_for_function(
        """([latest, above]) => Number(latest.textContent.replace("now ", "")) > above""",
        arg=[plot.locator(".ck-plot-latest").element_handle(), above],
    )


def test_the_sliders_of_lesson_three_set_what_the_plot_shows(lab: JupyterLab) -> None:
    lab.open("notebooks/03_parameters.ipynb")
    for start in (
        "%load_ext course_kit",
        "class Oven(Node)",
        "class WarmOven",
        "class Heater(Node)",  # brings an import
        "panels.parameter_sliders",
        "panels.plot",
    ):
        lab.run_cell_that_begins(start)

    plot = lab.scroll_to(lab.page.locator(".ck-plot"))
    sliders = lab.scroll_to(lab.page.locator(".ck-params"))
    target = sliders.locator("[data-name='target']")
    said = target.locator(".ck-params-status")
    target.locator("input[type='range']").fill("80")
    expect(said).to_have_text("✓ set")
    expect(target.locator("input[type='text']")).to_have_value("80.0")
    lab.picture("lesson_three_sliders")
    wait_for_value(plot, above=70.0)
    assert now(plot) <= 80.0
    lab.picture("lesson_three_plot")

    target.locator("input[type='range']").focus()
    lab.page.keyboard.press("ArrowRight")  # which JupyterLab has a use for, too
    expect(target.locator("input[type='text']")).not_to_have_value("80.0")
    lab.page.keyboard.press("End")  # 100 degrees, with the keyboard
    expect(target.locator("input[type='text']")).to_have_value("100.0")
    expect(said).to_have_attribute("data-state", "set")
    box = target.locator("input[type='text']")
    target.evaluate(TYPES_BEFORE_THE_ANSWER)
    expect(said).to_have_attribute("data-state", "set")
    expect(box).to_have_value("150")
    box.press("Enter")
    expect(said).to_contain_text("out of range")
    expect(box).to_have_value("90.0")
    expect(sliders.locator("[data-name='serial_number'] input")).to_be_disabled()
    expect(sliders.locator("[data-name='serial_number']")).to_contain_text(
        "read-only: it keeps the value it got at the start"
    )
    photograph(lab, sliders, "lesson_three_refused")
    narrow = "e => { e.style.width = '18rem'; return e.scrollWidth <= e.clientWidth }"
    assert sliders.evaluate(narrow)
    sliders.evaluate("e => { e.style.width = '' }")

    # A change made elsewhere moves the slider.
    lab.replace_cell_that_begins("%ros2 param set /oven", "%ros2 param set /oven target 35.0")
    lab.page.keyboard.press("Control+Enter")
    lab.scroll_to(sliders)
    expect(box).to_have_value("35.0")
    expect(said).to_have_text("↻ changed elsewhere")
    lab.scroll_to(plot).locator("svg").focus()
    lab.page.keyboard.press("ArrowLeft")
    expect(plot.locator(".ck-plot-spoken")).to_contain_text("s before the latest message")
    lab.picture("lesson_three_elsewhere")


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


@pytest.mark.answers
def test_the_launched_robot_drives_in_its_corridor(lab: JupyterLab) -> None:
    notebook = nbformat.read(lab.root / CAPSTONE, as_version=4)
    for cell in notebook.cells:
        if marked := re.match(r"%%submission delivery_robot (\S+)\n", cell.source):
            cell.source = marked[0] + (REPOSITORY / "solutions/delivery_robot" / marked[1]).read_text()
    run = ("load", "answer-", "run-delivery", "arena-delivery", "send-delivery")
    notebook.cells = [cell for cell in notebook.cells if cell.id.startswith(run)]
    nbformat.write(notebook, lab.root / CAPSTONE)
    lab.open(CAPSTONE)
    lab.run_all()
    lab.scroll_to(lab.page.locator(".ck-corridor"))
    panel = lab.page.locator(".ck-panel:has(.ck-corridor)")
    robot = panel.locator(".ck-robot")
    expect(panel).to_contain_text("The robot stands at dock.")
    expect(robot).to_have_attribute("style", re.compile(r"translate\(1\.2px"))
    form = lab.page.locator(".ck-panel:has-text('/deliver')")
    form.get_by_label("room").fill("lab")
    form.get_by_role("button", name="Send goal").click()
    expect(panel).to_contain_text(re.compile(r"is 0\.[2-7] m from the dock, on its way to lab\. The door is open"))
    lab.picture("corridor_on_its_way")
    expect(panel).to_contain_text("The robot stands at lab.")
    expect(robot).to_have_attribute("style", re.compile(r"translate\(10\.8px"))
    lab.require_no_error(CAPSTONE)

"""Lesson 2 in the browser: a goal is sent, followed and cancelled; the robot is sent about on its map."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

if TYPE_CHECKING:
    from playwright.sync_api import Locator

    from tests.browser.learner import JupyterLab

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]


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

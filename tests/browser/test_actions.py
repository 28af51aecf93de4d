"""Lesson 2 in the browser: a goal is sent, followed and cancelled; the robot is sent about on its map."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from tests.browser.pictures import photograph

if TYPE_CHECKING:
    from playwright.sync_api import Locator

    from tests.browser.learner import JupyterLab

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]


def test_lesson_two_is_run_and_its_panels_are_used(lab: JupyterLab) -> None:
    complaints: list[str] = []
    lab.page.on("console", lambda said: complaints.append(said.text) if said.type == "error" else None)
    lab.open("notebooks/02_actions.ipynb")
    lab.run_all()
    lab.require_no_error("notebooks/02_actions.ipynb")
    states = lab.page.locator(".jp-MarkdownCell img[alt^='The states of a goal']")
    for name, drawn in (("goal", lab.page.locator(".jp-CodeCell .ck-exchange svg")), ("states", states)):
        lab.scroll_to(drawn)
        expect(drawn.first).to_be_visible()
        drawn.first.scroll_into_view_if_needed()  # what is drawn above it has moved it
        lab.picture(f"lesson_two_{name}")
    blocked = lab.scroll_to(lab.page.locator(".ck-times", has_text="the cancel request to /fibonacci"))
    photograph(lab, blocked, "timeline_blocked_cancel")
    # The lesson has ended with `lab.stop()`; a cell that starts the server, and one for the robot, bring them back.
    lab.run_cell_that_begins("if len(feedback.sequence) == 4:")
    # A cell that was just run stays where it is; others come and go with what is drawn above them.
    lab.run_cell_that_begins('panels.action_panel("/sequence", Fibonacci)')
    send_and_cancel(lab, lab.page.locator(".ck-action:has(.ck-main:enabled)"))
    lab.run_cell_that_begins("from course_kit.panels.demo_robot import DemoRobot")
    lab.run_cell_that_begins("panels.robot_map()")
    drive(lab, lab.page.locator(".ck-map"))
    assert not complaints


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

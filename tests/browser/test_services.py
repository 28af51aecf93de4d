"""Lessons 0 and 1 in the browser: the graph that follows, the form that calls."""

from __future__ import annotations

import json
import os
import re
import subprocess
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from course_kit.quiz import guesses
from tests.browser.pictures import photograph

if TYPE_CHECKING:
    from playwright.sync_api import Locator

    from tests.browser.learner import JupyterLab

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]


def require_nothing_told_and_nothing_unsaved(lab: JupyterLab) -> None:
    """A lesson that has just been opened: no output spoils a guess, and its tab shows no unsaved change."""
    tab = lab.page.locator("#jp-main-dock-panel .lm-TabBar-tab", has_text="00_welcome.ipynb")
    expect(tab).to_have_count(1)
    assert "jp-mod-dirty" not in (tab.get_attribute("class") or "")
    cells = json.loads((lab.root / "notebooks/00_welcome.ipynb").read_text())["cells"]
    assert not any(cell.get("outputs") for cell in cells)
    # A change is shown there, so its absence means something.
    lab.page.locator(".jp-CodeCell .cm-content").first.click()
    lab.page.keyboard.type(" ")
    expect(tab).to_have_class(re.compile("jp-mod-dirty"))
    lab.page.keyboard.press("Backspace")


def guess_wrong_then_right_by_keyboard(lab: JupyterLab) -> None:
    """The arrow keys only choose; Enter guesses. The first try is what `./course list` counts."""
    name = "00_welcome/after_the_cell"
    asked = guesses.find_question(name)
    lab.run_cell_that_begins(f'panels.guess("{name}")')
    panel = lab.scroll_to(lab.page.locator(".ck-guess"))
    photograph(lab, panel, "guess_before")
    verdict, send = panel.get_by_role("status").first, panel.get_by_role("button", name="This is my guess")
    expect(send).to_be_disabled()
    wrong = next(choice for choice in asked.choices if not choice.is_right)
    choose(panel, asked.choices.index(wrong))
    expect(send).to_be_enabled()
    expect(verdict).to_be_hidden()
    lab.page.keyboard.press("Enter")
    expect(verdict).to_have_text("✗ Not quite. Run the next cell and look.")
    expect(verdict).to_be_focused()
    lab.run_cell_that_begins("from rclpy.node import Node")
    lab.scroll_to(panel)
    expect(verdict).to_contain_text(f"Not quite. {wrong.why}")
    expect(verdict).to_contain_text("The answer: It lives on and keeps publishing.")
    lab.run_cell_that_begins('lab.stop("battery")')
    lab.scroll_to(panel)
    photograph(lab, panel, "guess_after")
    panel.get_by_role("button", name="Try again").press("Enter")
    choose(panel, asked.right)
    lab.page.keyboard.press("Enter")
    expect(verdict).to_contain_text("Right.")
    # Shift+Enter goes on below the guess, and asks nothing again.
    lab.page.keyboard.press("Shift+Enter")
    expect(lab.page.locator(".jp-Cell:has(.ck-guess) + .jp-Cell")).to_have_class(re.compile("jp-mod-active"))
    expect(verdict).to_contain_text("Right.")
    kept = {**os.environ, "COURSE_KIT_PROGRESS": ""}
    command = [lab.root / "course", "list", "--format", "json"]
    listed = subprocess.run(command, cwd=lab.root, env=kept, capture_output=True, text=True, check=True)
    [score] = json.loads(listed.stdout)["questions"]
    assert (score["lesson"], score["right"], score["count"], score["answered"]) == ("00_welcome", 0, 3, 1)


def choose(panel: Locator, place: int) -> None:
    """Move to a choice with the arrow keys, from the first one."""
    panel.get_by_role("radio").first.focus()
    for key in ["Space", *["ArrowDown"] * place]:
        panel.page.keyboard.press(key)
    expect(panel.get_by_role("radio").nth(place)).to_be_checked()


def test_lesson_zero_shows_nodes_come_and_go(lab: JupyterLab) -> None:
    lab.open("notebooks/00_welcome.ipynb")
    require_nothing_told_and_nothing_unsaved(lab)
    lab.run_cell_that_begins("%load_ext course_kit")
    guess_wrong_then_right_by_keyboard(lab)
    lab.run_cell_that_begins("graph = panels.graph()")
    graph = lab.page.locator(".ck-graph")
    expect(graph).to_contain_text("No node is on the graph.")
    lab.run_cell_that_begins("from rclpy.node import Node")
    lab.scroll_to(graph)
    expect(graph.locator("[data-node=battery]")).to_contain_text("publishes")
    expect(graph.locator("[data-channel='/battery_voltage']")).to_contain_text("No node listens to /battery_voltage.")
    expect(graph.get_by_role("status")).to_have_text("battery has joined the graph.")
    lab.picture("lesson_zero_one_node")

    lab.run_cell_that_begins("class Dashboard(Node)")
    lab.scroll_to(graph)
    expect(graph.locator("[data-channel='/battery_voltage']")).not_to_contain_text("No node listens")
    expect(graph.locator(".ck-use[data-of=battery]")).to_have_count(1)
    graph.locator("[data-node=dashboard]").focus()
    expect(graph.locator(".ck-use.ck-on")).to_have_attribute("data-of", "dashboard")
    graph.get_by_text("The same as text").click()
    expect(graph.get_by_label("The graph as text")).to_contain_text(
        "listens to /battery_voltage [std_msgs/msg/Float64]"
    )
    lab.picture("lesson_zero_two_nodes")

    graph.get_by_label("Show ROS's own plumbing too").check()
    expect(graph.locator("[data-channel='/rosout']")).to_be_visible()
    graph.get_by_label("Show ROS's own plumbing too").uncheck()
    expect(graph.locator("[data-channel='/rosout']")).to_have_count(0)


def test_the_form_of_lesson_one_answers(lab: JupyterLab) -> None:
    page = lab.page
    lab.open("notebooks/01_services.ipynb")
    for start in (
        "%load_ext course_kit",
        "from rclpy.node import Node",
        "from example_interfaces.srv import AddTwoInts",
    ):
        lab.run_cell_that_begins(start)
    lab.run_cell_that_begins("class MinimalService(Node)")
    lab.run_cell_that_begins('panels.service_form("/add_two_ints"')
    form = lab.scroll_to(page.locator(".ck-form[aria-label='Call /add_two_ints']"))
    form.get_by_label("a", exact=True).fill("20")
    form.get_by_label("b", exact=True).fill("1.5")
    page.keyboard.press("Enter")
    outcome = form.get_by_role("status")
    expect(outcome).to_contain_text("b: expected a whole number")
    expect(form.get_by_label("b", exact=True)).to_be_focused()
    expect(form.get_by_label("b", exact=True)).to_have_attribute("aria-invalid", "true")
    lab.picture("lesson_one_form_refuses")
    page.keyboard.press("Control+A")
    page.keyboard.type("22")
    page.keyboard.press("Enter")
    expect(outcome.get_by_role("row", name="sum")).to_contain_text("42")
    expect(outcome).to_contain_text("[INFO] [minimal_service]: Incoming request")
    expect(form.get_by_label("b", exact=True)).not_to_have_attribute("aria-invalid", "true")
    lab.picture("lesson_one_form_answers")

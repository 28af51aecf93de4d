"""Lessons 0 and 1 in the browser: the graph that follows, with its messages; the form that calls; the diagram."""

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

# Notes each dot that begins to run, where its two halves of a way lead.
WATCH_DOTS = """() => {
  window.dots = [];
  window.lit = [];
  new MutationObserver(changes => {
    for (const { addedNodes, target, type } of changes) {
      if (type === "attributes" && target.classList.contains("ck-crossed")) window.lit.push(target.dataset.of);
      for (const one of addedNodes) {
        if (one.classList?.contains("ck-dot"))
          window.dots.push(`${one.dataset.way} ${one.dataset.of} ${one.dataset.on}`);
        else if (one.parentElement?.matches(".ck-rate")) window.lit.push(one.textContent);
      }
    }
  }).observe(document.body, { attributeFilter: ["class"], childList: true, subtree: true });
}"""

# Whether a second goes by in which none begins.
NO_MORE_DOTS = """() => new Promise(done => {
  const before = window.dots.length;
  setTimeout(() => done(window.dots.length === before), 1000);
})"""
# The battery of the lesson without its timer.
QUIET = """lab.stop("battery")

class Quiet(Node):
    def __init__(self):
        super().__init__("battery")
        self.publisher = self.create_publisher(Float64, "battery_voltage", 10)

battery = lab.start(Quiet)"""
MANY = "for n in range(60):\n    battery.publisher.publish(Float64(data=float(n)))"
# A node whose messages are long.
LONG = """class Chatty(Node):
    def __init__(self):
        super().__init__("chatty")
        self.create_subscription(String, "said", self.hear, 10)
        self.publisher = self.create_publisher(String, "echo", 10)

    def hear(self, message):
        self.publisher.publish(message)

from std_msgs.msg import String
lab.start(Chatty)
await lab.call("/add_two_ints", AddTwoInts, a=3, b=4)
lab.publish("/said", String, data="word " * 20)
lab.diagram()"""


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
    choose(panel, asked.right_place)
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


def test_lesson_zero_shows_nodes_and_messages_come_and_go(lab: JupyterLab) -> None:
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
    graph.get_by_text("The same in words").click()
    expect(graph.get_by_label("The graph as text")).to_contain_text(
        "listens to /battery_voltage [std_msgs/msg/Float64]"
    )
    lab.picture("lesson_zero_two_nodes")

    graph.get_by_label("Show ROS's own plumbing too").check()
    expect(graph.locator("[data-channel='/rosout']")).to_be_visible()
    graph.locator("[data-channel='/rosout']").hover()
    expect(graph.locator(".ck-use.ck-on")).to_have_count(2)
    graph.get_by_label("Show ROS's own plumbing too").press("Space")
    expect(graph.locator("[data-channel='/rosout']")).to_have_count(0)
    expect(lab.page.locator(".ck-marking:not(:has(.ck-on))")).to_have_count(0)  # what was pointed at is gone
    see_messages_run_along_the_arrows(lab, graph)


def see_messages_run_along_the_arrows(lab: JupyterLab, graph: Locator) -> None:
    places = [
        middle_of(graph.locator(one)) for one in ("[data-node=battery]", ".ck-box.ck-topic", "[data-node=dashboard]")
    ]
    assert places == sorted(places)
    lab.page.evaluate(WATCH_DOTS)
    lab.page.wait_for_function("window.dots.length >= 4")  # the battery's own messages
    photograph(lab, graph, "graph")

    run_elsewhere(lab, QUIET)
    expect(graph.locator(".ck-use[data-of=dashboard]")).to_be_attached()
    lab.page.wait_for_function(NO_MORE_DOTS)
    lab.page.evaluate("window.dots.length = 0")
    run_elsewhere(lab, "battery.publisher.publish(Float64(data=11.0))")
    lab.page.wait_for_function("window.dots.length >= 2")
    assert lab.page.evaluate("window.dots") == ["out battery /battery_voltage", "in dashboard /battery_voltage"]
    expect(graph.locator(".ck-dot")).to_have_count(0)

    # What no eye can follow is a number, and no dot moves; many at once are no rate.
    run_elsewhere(lab, f"import asyncio\n{MANY}")
    expect(graph.locator(".ck-dot")).to_have_count(0)
    assert not any("/s" in one for one in lab.page.evaluate("window.lit"))
    run_elsewhere(lab, f"{MANY}\n    await asyncio.sleep(0.05)")
    lab.page.wait_for_function(r"window.lit.some(one => /\d+\/s/.test(one))")  # both are there for moments
    expect(graph.locator(".ck-rate")).to_have_count(0)
    lab.page.emulate_media(reduced_motion="reduce")
    lab.page.evaluate("window.dots.length = 0")
    run_elsewhere(lab, "battery.publisher.publish(Float64(data=11.0))")
    lab.page.wait_for_function("window.lit.includes('dashboard')")
    assert lab.page.evaluate("window.dots") == []


def middle_of(shown: Locator) -> float:
    frame = shown.bounding_box()
    assert frame is not None
    return frame["x"] + frame["width"] / 2


def run_elsewhere(lab: JupyterLab, code: str) -> None:
    """Run a line in the notebook's kernel while the graph stays in view."""
    lab.page.evaluate(
        """async code => {
            const panel = [...window.jupyterapp.shell.widgets("main")].find(one => one.sessionContext && one.context);
            await panel.sessionContext.session.kernel.requestExecute({ code }).done;
        }""",
        code,
    )


def test_the_form_of_lesson_one_answers_and_the_diagram_draws(lab: JupyterLab) -> None:
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
    go_through_the_diagram_by_keyboard(lab)


def go_through_the_diagram_by_keyboard(lab: JupyterLab) -> None:
    page = lab.page
    lab.run_cell_that_begins("lab.record()")
    lab.replace_cell_that_begins("lab.diagram()", LONG)
    lab.run_cell_that_begins("class Chatty(Node)")
    drawn = lab.scroll_to(page.locator(".ck-exchange", has_text="word"))
    slider = drawn.get_by_role("slider")
    steps = drawn.locator(".ck-step")
    count = steps.count()
    assert count >= 6
    expect(drawn.locator(".ck-later")).to_have_count(0)
    slider.click()
    expect(slider).to_be_focused()
    page.keyboard.press("Home")
    expect(drawn.locator(".ck-later")).to_have_count(count - 1)
    expect(drawn.locator("output")).to_have_text(f"1 of {count}")
    expect(slider).to_be_focused()
    page.keyboard.press("ArrowRight")
    expect(drawn.locator(".ck-later")).to_have_count(count - 2)
    expect(drawn.locator(".ck-current")).to_have_count(1)
    expect(slider).to_have_attribute("aria-valuetext", re.compile(f"^2 of {count}: minimal_service -> lab"))
    photograph(lab, drawn, "diagram")
    page.keyboard.press("End")
    expect(drawn.locator(".ck-later")).to_have_count(0)

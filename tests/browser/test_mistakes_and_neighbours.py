"""What a learner sees in the browser of grades, of other notebooks, and behind links."""

from __future__ import annotations

import re
import shutil
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from tests.browser.pictures import photograph
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from playwright.sync_api import Page

    from tests.browser.learner import JupyterLab

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]
BROKEN = REPOSITORY / "tests/broken/temperature_service/service.no_return.py"
EXERCISE = "exercises/temperature_service/temperature_service.ipynb"


def grade_the_broken_one(lab: JupyterLab) -> None:
    """Follow the link of its card to the lesson."""
    lab.replace_cell_that_begins("%load_ext", f"%load_ext course_kit\n%grade temperature_service {BROKEN.name}")
    lab.page.keyboard.press("Shift+Enter")
    card = lab.page.locator(".course-kit-report").first
    expect(card.locator("li.failed")).to_have_count(1)
    expect(card.get_by_text("points, not passed yet")).to_be_in_viewport()  # its head, not its end
    card.get_by_role("link", name=re.compile("7.2 No return")).click()


def require_landed(page: Page) -> None:
    """The heading is the first thing below the toolbar, and stays there."""
    heading = page.locator(".jp-NotebookPanel:not(.lm-mod-hidden) h3", has_text="7.2")
    expect(heading).to_be_in_viewport()
    page.wait_for_function(
        """heading => {
            const top = heading.getBoundingClientRect().top;
            window.calm = window.top_before === top ? (window.calm ?? 0) + 1 : 0;
            window.top_before = top;
            return window.calm > 10 && top > 50 && top < 300;
        }""",
        arg=heading.element_handle(),
        polling=100,
    )


def test_a_link_lands_at_its_heading_at_the_first_click_in_notebook_7(lab: JupyterLab) -> None:
    shutil.copy(BROKEN, lab.root / "exercises/temperature_service")
    lab.open_in_notebook_7(EXERCISE)
    with lab.page.context.expect_page() as opened:
        grade_the_broken_one(lab)
    require_landed(opened.value)


def test_nodes_left_in_another_notebook_are_shown_apart_until_they_are_stopped(lab: JupyterLab) -> None:
    lab.open("notebooks/02_actions.ipynb")
    lab.run_cell_that_begins("%load_ext course_kit")
    lab.run_cell_that_begins("import time\n\nfrom rclpy.node import Node".partition("\n")[0])
    lab.open("notebooks/00_welcome.ipynb")
    lab.run_cell_that_begins("%load_ext course_kit")
    lab.run_cell_that_begins("graph = panels.graph()")
    theirs = lab.page.locator(".ck-graph .ck-elsewhere[data-node=coffee_machine]")
    expect(theirs).to_contain_text("in 02_actions.ipynb")
    photograph(lab, lab.scroll_to(lab.page.locator(".ck-graph")), "other_notebooks")
    lab.replace_cell_that_begins("from rclpy.node import Node", "lab.stop_others()")
    lab.page.keyboard.press("Shift+Enter")
    expect(lab.page.locator(".ck-graph [data-node=coffee_machine]")).to_have_count(0)


@pytest.mark.answers
def test_grade_follows_what_the_notebook_shows(lab: JupyterLab) -> None:
    solution = (REPOSITORY / "solutions/temperature_service/temperature_service.py").read_text()
    lab.open(EXERCISE)
    lab.run_cell_that_begins("%load_ext course_kit")
    lab.replace_cell_that_begins("%%submission", "%%submission temperature_service\n" + solution)
    lab.page.keyboard.press("Control+Enter")
    lab.run_cell_that_begins("%grade")
    graded = lab.page.locator(".jp-CodeCell", has_text="%grade").last
    expect(graded).to_contain_text(re.compile(r"Grading In\[2\], run at \d\d:\d\d:\d\d\."))
    expect(graded).to_contain_text("10 of 10")
    expect(graded).to_contain_text("Next: lesson 2, notebooks/02_actions.ipynb; then exercise 2, move_robot.")
    lab.scroll_to(lab.page.locator(".jp-CodeCell", has_text="%%submission")).locator(".cm-content").click()
    lab.page.keyboard.press("Escape")
    lab.page.keyboard.press("d")
    lab.page.keyboard.press("d")
    lab.run_cell_that_begins("%grade")
    expect(graded).to_contain_text("Nothing to grade yet: run the cell that begins with %%submission")

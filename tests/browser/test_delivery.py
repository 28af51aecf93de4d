"""The capstone in the browser: three programs of a notebook's cells are launched, and a button sends the robot off."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import nbformat
import pytest
from playwright.sync_api import expect

from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from tests.browser.learner import JupyterLab

pytestmark = [pytest.mark.browser, pytest.mark.answers, pytest.mark.timeout(900)]
NOTEBOOK = "exercises/delivery_robot/delivery_robot.ipynb"


def test_the_launched_robot_drives_in_its_corridor(lab: JupyterLab) -> None:
    notebook = nbformat.read(lab.root / NOTEBOOK, as_version=4)
    for cell in notebook.cells:
        if marked := re.match(r"%%submission delivery_robot (\S+)\n", cell.source):
            cell.source = marked[0] + (REPOSITORY / "solutions/delivery_robot" / marked[1]).read_text()
    run = ("load", "answer-", "run-delivery", "arena-delivery")
    notebook.cells = [cell for cell in notebook.cells if cell.id.startswith(run)]
    nbformat.write(notebook, lab.root / NOTEBOOK)
    lab.open(NOTEBOOK)
    lab.run_all()
    lab.scroll_to(lab.page.locator(".ck-corridor"))
    panel = lab.page.locator(".ck-panel:has(.ck-corridor)")
    robot = panel.locator(".ck-robot")
    expect(panel).to_contain_text("The robot stands at dock.")
    expect(robot).to_have_attribute("style", re.compile(r"translate\(1\.2px"))
    panel.get_by_role("button", name="lab", exact=True).click()
    expect(panel).to_contain_text(re.compile(r"is 0\.[2-7] m from the dock, on its way to lab\. The door is open"))
    lab.picture("corridor_on_its_way")
    expect(panel).to_contain_text("has succeeded (SUCCEEDED). The robot stands at lab.")
    expect(robot).to_have_attribute("style", re.compile(r"translate\(10\.8px"))
    lab.require_no_error(NOTEBOOK)

"""Lesson 6 and the demos in the browser; and that no notebook of the course is left out of these tests."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from tests.browser.pictures import photograph
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from tests.browser.learner import JupyterLab

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

DEMOS = sorted(path.name for path in (REPOSITORY / "notebooks/demos").glob("*.ipynb"))


def test_lesson_six_runs_and_its_guards_hold_against_the_mouse(lab: JupyterLab) -> None:
    lab.open("notebooks/06_best_practices.ipynb")
    lab.run_all()
    lab.require_no_error("notebooks/06_best_practices.ipynb")
    lab.run_cell_that_begins("class Guarded(Node)")  # the lesson has ended with `lab.stop()`
    sliders = lab.scroll_to(lab.page.locator(".ck-params"))
    highest = sliders.locator("[data-name='max_velocity']")
    highest.locator("input[type='range']").focus()
    lab.page.keyboard.press("Home")
    expect(highest.locator(".ck-params-status")).to_contain_text("min_velocity would be above max_velocity")
    expect(sliders.locator("[data-name='wheel_diameter'] input")).to_be_disabled()
    lab.picture("lesson_six_refusal")


def test_the_drills_run_and_one_is_repaired_and_graded(lab: JupyterLab) -> None:
    lab.open("notebooks/07_drills.ipynb")
    lab.run_all()
    lab.require_no_error("notebooks/07_drills.ipynb")
    drill = "exercises/drills/dark_lamp/dark_lamp.ipynb"
    lab.open(drill)
    lab.run_all()
    lab.require_no_error(drill)
    card = lab.scroll_to(lab.page.locator(".course-kit-report"))
    expect(card.locator("li.failed").first).to_be_visible()
    photograph(lab, card, "drill_not_done")
    cells = json.loads((lab.root / drill).read_text())["cells"]
    program = next(source for cell in cells if (source := "".join(cell["source"])).startswith("%%submission"))
    lab.scroll_to(lab.page.locator(".jp-CodeCell", has_text="%%submission"))
    lab.replace_cell_that_begins("%%submission", program.replace("Float32", "Float64"))
    lab.run_all()
    expect(card).to_be_visible()
    expect(card.locator("li.failed")).to_have_count(0)
    photograph(lab, card, "drill_done")


def test_panels_work_in_notebook_7(lab: JupyterLab) -> None:
    lab.open_in_notebook_7("notebooks/06_best_practices.ipynb")
    lab.run_all()
    # The lesson has ended with `lab.stop()`.
    for start in ("from my_interfaces.srv import SetGripperWidth", "class Guarded(Node)"):
        lab.run_cell_that_begins(start)
    form = lab.scroll_to(lab.page.locator(".ck-form[aria-label='Call /set_gripper_width']"))
    expect(form).to_contain_text("float64: a number · metres, 0.0 to MAX_WIDTH")
    form.get_by_label("width", exact=True).fill("0.03")
    lab.page.keyboard.press("Enter")
    expect(form.get_by_role("status")).to_contain_text("0.03")
    sliders = lab.scroll_to(lab.page.locator(".ck-params"))
    sliders.locator("[data-name='max_velocity'] input[type='range']").focus()
    lab.page.keyboard.press("Home")
    expect(sliders).to_contain_text("min_velocity would be above max_velocity")
    lab.picture("notebook_7")


def test_every_demo_shows_its_failure(lab: JupyterLab) -> None:
    for name in DEMOS:
        lab.open(f"notebooks/demos/{name}")
        lab.run_all()
        lab.scroll_to(lab.page.get_by_text("It fails:").first)
        lab.require_no_error(f"notebooks/demos/{name}")
        lab.picture(f"demo_{name.partition('_')[0]}")


def test_every_notebook_of_the_course_is_opened_in_the_browser() -> None:
    tests = "".join(path.read_text() for path in (REPOSITORY / "tests/browser").glob("test_*.py"))
    lessons = [path.relative_to(REPOSITORY).as_posix() for path in (REPOSITORY / "notebooks").glob("*.ipynb")]
    assert lessons
    assert not [name for name in lessons if name not in tests]
    assert DEMOS

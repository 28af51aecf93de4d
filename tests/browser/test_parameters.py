"""Lesson 3 in the browser: a learner moves a slider, sees the plot follow, and is refused."""

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
    lab.page.keyboard.press("End")  # 100 degrees, with the keyboard
    expect(target.locator("input[type='text']")).to_have_value("100.0")
    expect(said).to_have_text("✓ set")
    box = target.locator("input[type='text']")
    box.fill("150")
    box.press("Enter")
    expect(said).to_contain_text("out of range")
    expect(box).to_have_value("100.0")
    expect(sliders.locator("[data-name='serial_number'] input")).to_be_disabled()
    expect(sliders.locator("[data-name='serial_number']")).to_contain_text(
        "read-only: it keeps the value it got at the start"
    )
    photograph(lab, sliders, "lesson_three_refused")

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

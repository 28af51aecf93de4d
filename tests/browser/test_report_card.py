"""The card of a grade, in the browser: read, unfolded and followed with the keyboard alone."""

from __future__ import annotations

import re
import shutil
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from tests.browser.learner import ARTIFACTS
from tests.browser.test_mistakes_and_neighbours import require_landed
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from playwright.sync_api import Locator

    from tests.browser.learner import JupyterLab

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]
BROKEN = REPOSITORY / "tests/broken/temperature_service/service.no_return.py"
GRADE = f"""%load_ext course_kit
%grade temperature_service {BROKEN.name}"""


def test_a_failed_check_shows_its_exchange_its_hint_and_the_way_to_the_lesson(lab: JupyterLab) -> None:
    shutil.copy(BROKEN, lab.root / "exercises/temperature_service")
    lab.open("exercises/temperature_service/temperature_service.ipynb")
    lab.replace_cell_that_begins("%load_ext", GRADE)
    lab.page.keyboard.press("Shift+Enter")
    card = lab.page.locator(".course-kit-report").first
    expect(card.locator("li.failed")).to_have_count(1)
    drawing = card.get_by_role("img", name="Sequence diagram of 2 steps")
    drawing.scroll_into_view_if_needed()
    expect(drawing).to_be_visible()
    assert drawing.evaluate("drawing => drawing.getBoundingClientRect().width") > 300
    label = card.locator("dt", has_text="Why that happens")
    assert label.evaluate("label => label.getBoundingClientRect().width") > 100  # JupyterLab's own style breaks it
    pictures(lab, card)

    hint = card.get_by_text("How does the response you have filled in get out of the function")
    expect(hint).not_to_be_visible()
    tab_to(lab, card, "Show a hint")
    lab.page.keyboard.press("Enter")
    expect(hint).to_be_visible()

    tab_to(lab, card, "7.2 No return")
    lab.page.keyboard.press("Enter")
    require_landed(lab.page)


def tab_to(lab: JupyterLab, card: Locator, text: str) -> None:
    """From the first thing in the card that takes the focus, go on with Tab until `text` has it."""
    card.locator("li.failed > details > summary").focus()
    for _ in range(10):
        if text in str(lab.page.evaluate("document.activeElement.textContent")):
            break
        lab.page.keyboard.press("Tab")
    expect(card.locator(":focus")).to_contain_text(text)


def pictures(lab: JupyterLab, card: Locator) -> None:
    """The card in both themes of JupyterLab: what it says is darker or lighter than what is behind it."""
    ARTIFACTS.mkdir(parents=True, exist_ok=True)
    for theme in ("JupyterLab Light", "JupyterLab Dark"):
        lab.page.get_by_role("menuitem", name="Settings", exact=True).click()
        lab.page.locator(".lm-Menu-itemLabel", has_text=re.compile("^Theme$")).hover()
        lab.page.locator(".lm-Menu-itemLabel", has_text=re.compile(f"^{theme}$")).click()
        expect(lab.page.locator(f"body[data-jp-theme-name='{theme}']")).to_be_attached()
        card.screenshot(path=ARTIFACTS / f"report_card_{theme.rpartition(' ')[2].lower()}.png")
        colours = card.evaluate("card => [getComputedStyle(card).color, getComputedStyle(card).backgroundColor]")
        assert contrast(*colours) > 4.5, colours


def contrast(*colours: str) -> float:
    """The contrast of two CSS colours as WCAG has it, taken as if they were without transparency."""
    light, dark = sorted((luminance(colour) for colour in colours), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def luminance(colour: str) -> float:
    """Of `rgb(1, 2, 3)`, from 0 to 1."""
    parts = [float(part) / 255 for part in colour[colour.index("(") + 1 : -1].split(",")[:3]]
    red, green, blue = (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue

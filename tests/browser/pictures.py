"""What tests of pictures share: themes, sizes of the window, and what axe finds in a part of a page."""

from __future__ import annotations

import json
from contextlib import contextmanager
from typing import TYPE_CHECKING

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from tests.browser.learner import PATIENCE_MS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser, Locator, Page

    from tests.browser.learner import JupyterLab

THEMES = {"light": "JupyterLab Light", "dark": "JupyterLab Dark"}


def use_theme(page: Page, theme: str) -> None:
    """Switch JupyterLab to "light" or "dark", as its settings do."""
    page.evaluate(
        "theme => window.jupyterapp.commands.execute('apputils:change-theme', { theme })",
        THEMES[theme],
    )
    page.locator(f"body[data-jp-theme-light='{str(theme == 'light').lower()}']").wait_for(state="attached")


def photograph(lab: JupyterLab, shown: Locator, name: str) -> None:
    """Screenshots of it, and axe finds nothing, in either theme."""
    for theme in THEMES:
        use_theme(lab.page, theme)
        shown.scroll_into_view_if_needed()
        lab.picture(f"{name}_{theme}")
        require_no_findings(lab.page, shown)
    use_theme(lab.page, "light")


@contextmanager
def offline_page(chromium: Browser) -> Iterator[Page]:
    """A page that has no network at all."""
    opened = chromium.new_page(viewport={"width": 1280, "height": 1000}, offline=True)
    opened.set_default_timeout(PATIENCE_MS)
    expect.set_options(timeout=PATIENCE_MS)
    yield opened
    opened.close()


def require_no_findings(page: Page, part: Locator) -> None:
    """Have axe look at a part of the page, or at several at once: each time it reads the whole page."""
    part.evaluate_all("parts => parts.forEach(part => part.setAttribute('data-axe', ''))")
    found = Axe().run(page, context="[data-axe]")
    part.evaluate_all("parts => parts.forEach(part => part.removeAttribute('data-axe'))")
    told = [
        {
            "id": one["id"],
            "help": one["help"],
            "where": [(node["html"][:200], node["failureSummary"]) for node in one["nodes"]],
        }
        for one in found.response["violations"]
    ]
    assert not told, json.dumps(told, indent=1)
    assert found.response["passes"]

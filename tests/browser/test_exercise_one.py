"""The first exercise, in the browser."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from tests.browser.learner import JupyterLab

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]


@pytest.mark.answers
def test_exercise_one_is_filled_in_and_graded(lab: JupyterLab) -> None:
    solution = (REPOSITORY / "solutions/temperature_service/temperature_service.py").read_text()
    lab.open("exercises/temperature_service/temperature_service.ipynb")
    lab.run_all()
    lab.picture("exercise_one_starter")
    card = lab.page.locator(".course-kit-report").last
    expect(card).to_contain_text("not passed")
    lab.replace_cell_that_begins("%%submission", "%%submission temperature_service\n" + solution)
    lab.run_all()
    expect(card).to_contain_text("10 of 10")
    card.scroll_into_view_if_needed()
    lab.picture("exercise_one_graded")

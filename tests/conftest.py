"""Fixtures for all rooms, and what happens to the browser tests where there is no browser."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.dev import browser

if TYPE_CHECKING:
    from collections.abc import Iterator

environment.apply()  # before any test module imports rclpy
os.environ["COURSE_KIT_PROGRESS"] = "off"  # what tests grade is not what the person at this machine has reached
_WITHOUT_BROWSER = (
    "No Chromium on this machine: the browser tests are left out. Debian, Ubuntu: sudo apt install chromium"
)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave the browser tests out on a learner's machine without Chromium; on CI they must run."""
    if browser.find() or os.environ.get("CI"):
        return
    left_out = [item for item in items if item.get_closest_marker("browser")]
    config.hook.pytest_deselected(items=left_out)
    items[:] = [item for item in items if item not in left_out]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say at the end, too, that something was left out."""
    if terminalreporter.stats.get("deselected") and not browser.find():
        terminalreporter.section("browser")
        terminalreporter.write_line(_WITHOUT_BROWSER)


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain nobody else uses, also in ROS_DOMAIN_ID for the processes a test starts."""
    with environment.exclusive_domain() as domain_id:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain_id))
        yield domain_id

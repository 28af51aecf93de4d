"""Fixtures for all tests, and what happens to the browser tests where there is no browser."""

from __future__ import annotations

import difflib
import os
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, settings

from course_kit import environment
from course_kit.dev import suite
from tests import sizes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from course_kit.lab.runtime.core import Lab

environment.heed_interrupts()  # tests press Ctrl-C, wherever they were started from
environment.apply_settings()  # before any test module imports rclpy
os.environ["COURSE_KIT_PROGRESS"] = "off"  # what tests grade is not what the person at this machine has reached
# A slow or busy machine is no fault of what is tested: whoever has the student edition runs these tests, too.
settings.register_profile("any machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any machine")
_WITHOUT_BROWSER = (
    "No Chromium on this machine: the browser tests are left out. Debian, Ubuntu: sudo apt install chromium"
)
_WITHOUT_ANSWERS = "This is the student edition: the tests that need the solutions are left out."
REPOSITORY = Path(__file__).resolve().parent.parent


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--freeze`, for a change of tests/frozen that is meant: git then shows what it is."""
    parser.addoption("--freeze", action="store_true", help="write what lies in tests/frozen anew")


def pytest_itemcollected(item: pytest.Item) -> None:
    """Mark what is left out of the usual run, or of a quick one."""
    for mark in sizes.marks_of(item.nodeid):
        item.add_marker(mark)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what cannot be run: browser tests without Chromium (on CI they must run), and tests of the
    solutions in the student edition. What computes long comes early, so that workers end at about the same time.
    """
    missing = {name for name, _ in _missing()}
    left_out = [item for item in items if any(item.get_closest_marker(name) for name in missing)]
    config.hook.pytest_deselected(items=left_out)
    kept = [item for item in items if item not in left_out]
    places = sizes.places(dict.fromkeys(file_of(item) for item in kept))
    items[:] = sorted(kept, key=lambda item: places[file_of(item)])


def file_of(item: pytest.Item) -> str:
    """The part of its id that xdist keeps together."""
    return item.nodeid.partition("::")[0]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say at the end, too, that something was left out."""
    if terminalreporter.stats.get("deselected"):
        for name, sentence in _missing():
            terminalreporter.section(name)
            terminalreporter.write_line(sentence)


def _missing() -> Iterator[tuple[str, str]]:
    """Markers of the tests that have no chance here, and why."""
    if not suite.find_browser() and not os.environ.get("CI"):
        yield "browser", _WITHOUT_BROWSER
    if not (REPOSITORY / "solutions").is_dir():
        yield "answers", _WITHOUT_ANSWERS


@pytest.fixture
def frozen(pytestconfig: pytest.Config) -> Callable[[str, str], None]:
    """Compares a text with a file of tests/frozen; with `--freeze` it writes that file."""

    def compare(name: str, found: str) -> None:
        path = REPOSITORY / "tests" / "frozen" / name
        if pytestconfig.getoption("freeze"):
            path.write_text(found, encoding="utf-8")
        kept = path.read_text(encoding="utf-8") if path.is_file() else ""
        changed = list(difflib.unified_diff(kept.splitlines(), found.splitlines(), "frozen", "now", n=0, lineterm=""))
        assert not changed, "\n".join([*changed, f"Where that is meant: ./course test tests/frozen --freeze ({name})"])

    return compare


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain nobody else uses, also in ROS_DOMAIN_ID for the processes a test starts."""
    with environment.exclusive_domain() as domain_id:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain_id))
        yield domain_id


@pytest.fixture
def own_lab(domain: int) -> Iterator[Lab]:
    """A fresh lab on a domain of its own, as the current one."""
    from tests.lab.fresh import fresh_lab  # brings rclpy

    assert domain
    with fresh_lab() as mine:
        yield mine

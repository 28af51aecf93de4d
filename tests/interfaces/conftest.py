"""Leaves out the comparison with a real build where a build is impossible."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.interfaces import reference_build

if TYPE_CHECKING:
    import pytest

_MISSING = reference_build.missing()
collect_ignore = ["test_reference_build.py"] if _MISSING else []


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say what was left out, and why."""
    if _MISSING:
        terminalreporter.section("interfaces")
        terminalreporter.write_line(
            f"No {_MISSING} on this machine: live types were compared with the wheels' types only."
        )

"""artifacts/attacks.md: every attack that a test runs, and whether it held in this run.

Under each kind of isolation the tests of `tests/grading/sandbox/test_attacks.py` say it in a table of their own. All
others are marked with `attack`: what they try does not depend on isolation, or they see to their own.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterable

PATH = Path(__file__).resolve().parent.parent / "artifacts" / "attacks.md"
TABLE, ROW = "table of attacks", "attack"
_PARAMETER = re.compile(r"\[(.*)\]\Z", re.DOTALL)
_LONGEST = 100  # characters of a parameter


class AttackTable:
    """A plugin of pytest; beside xdist it collects in the process that the others report to."""

    def __init__(self) -> None:
        self._table = ""
        self._rows: dict[str, dict[str, bool]] = {}

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """Have the report of a marked test say what it is about."""
        if marker := item.get_closest_marker(ROW):
            item.user_properties.append((ROW, (marker.args[0], words_of(item.name))))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Take what a test says."""
        if report.when != "call":
            return
        for name, value in report.user_properties:
            if name == TABLE:
                self._table = str(value)
            elif name == ROW and isinstance(value, (tuple, list)):
                about, attack = value
                rows = self._rows.setdefault(about, {})
                rows[attack] = rows.get(attack, True) and report.passed

    def pytest_sessionfinish(self) -> None:
        """Write the file, in runs that have the table of the isolated attacks."""
        if self._table:
            PATH.parent.mkdir(exist_ok=True)
            PATH.write_text("\n".join([self._table, *self._sections()]) + "\n", encoding="utf-8")

    def _sections(self) -> Iterable[str]:
        for about, rows in sorted(self._rows.items()):
            yield from ("", f"## {about}", "", "| tried with the isolation that this machine allows | |", "|---|---|")
            for attack, held in sorted(rows.items()):
                yield f"| {attack} | {'held' if held else '**not held**'} |"


def words_of(test: str) -> str:
    """The name of a test as a sentence, with what it was called with."""
    found = _PARAMETER.search(test)
    parameter = " ".join(found[1].replace("|", "\\|").split())[:_LONGEST] if found else ""
    words = _PARAMETER.sub("", test).removeprefix("test_").replace("_", " ")
    return f"{words} ({parameter})" if parameter else words

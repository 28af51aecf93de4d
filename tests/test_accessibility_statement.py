"""The accessibility statement claims what the browser tests look at: no more, and no less."""

from __future__ import annotations

import re

from course_kit import environment
from tests.course_copy import REPOSITORY

STATEMENT = environment.PACKAGE / "guides" / "accessibility.md"
RUNS_AXE = re.compile(r"\b(?:photograph|require_no_findings)\(\w+[.,]|\bAxe\(\)\.run\(")
PRESSES_KEYS = re.compile(r"\.press\(")


def list_tests_named(column: int) -> list[str]:
    rows = [line.split("|") for line in STATEMENT.read_text(encoding="utf-8").splitlines() if "`tests/" in line]
    return [name for row in rows for name in re.findall(r"`(tests/[^`]+)`", row[column])]


def test_the_statement_names_each_test_that_runs_axe_and_only_tests_that_press_keys() -> None:
    programs = {
        path.relative_to(REPOSITORY).as_posix(): path.read_text() for path in REPOSITORY.glob("tests/*/test_*.py")
    }
    assert set(list_tests_named(2)) == {name for name, text in programs.items() if RUNS_AXE.search(text)}
    with_keys = list_tests_named(3)
    assert len(with_keys) > 5
    assert set(with_keys) <= {name for name, text in programs.items() if PRESSES_KEYS.search(text)}

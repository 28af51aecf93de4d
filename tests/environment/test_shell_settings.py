"""What a shell may have set, and what must not change a grade."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    import pytest


def test_what_we_make_we_can_use_whatever_the_umask() -> None:
    before = os.umask(0o700)
    try:
        environment.apply()
        now = os.umask(0o022)
    finally:
        os.umask(before)
    assert now & 0o700 == 0


def test_a_child_keeps_its_docstrings(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONOPTIMIZE", "2")
    assert "PYTHONOPTIMIZE" not in environment.child_environment()

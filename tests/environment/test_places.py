"""Where things are kept, and how the user calls the course."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    from pathlib import Path

    import pytest


def test_the_course_is_called_by_its_door_where_that_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    root = environment.checkout()
    assert root is not None
    monkeypatch.chdir(root)
    assert environment.command() == "./course"
    monkeypatch.chdir(tmp_path)
    assert environment.command() == "course-kit"
    tmp_path.rmdir()
    assert environment.command() == "course-kit"

"""Whether `course-kit dev hub` says what a machine lacks; the trial itself is in tests/hub."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.dev import browser, hub

if TYPE_CHECKING:
    from pathlib import Path

    import pytest


def test_an_ordinary_user_is_told_that_only_root_can(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "only root can run it" in hub.lacking(1000)
    assert "only root can run it" not in hub.lacking(0)
    monkeypatch.setattr(hub, "lacking", lambda _: ["only root can run it"])
    assert hub.main([]) == 2


def test_each_missing_program_is_named_with_its_package(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("COURSE_BROWSER", str(tmp_path / "none"))
    assert browser.find() is None
    said = "; ".join(hub.lacking(0))
    for sentence in ("no npm (Debian, Ubuntu: apt install npm)", "no useradd", "no git", "no Chromium"):
        assert sentence in said

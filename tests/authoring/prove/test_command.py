"""`course-kit prove` at a terminal: its exit codes, and Ctrl-C."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.authoring.prove import proving
from course_kit.cli import main
from course_kit.grading.model import exercise

if TYPE_CHECKING:
    from tests.authoring.prove.conftest import Tiny

ARGUMENTS = ("prove", "tiny", "--workers", "1", "--quick")


@pytest.fixture
def known(tiny: Tiny, monkeypatch: pytest.MonkeyPatch) -> Tiny:
    """The tiny exercise, where the command finds it."""
    made = tiny.exercise
    monkeypatch.setattr(exercise, "load_exercise", lambda *_: made)
    return tiny


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main.main([*ARGUMENTS, *arguments])
    shown = capsys.readouterr()
    return code, shown.out, shown.err


def test_nothing_found(known: Tiny, capsys: pytest.CaptureFixture[str]) -> None:
    del known
    code, out, err = run(capsys)
    assert code == 0, err
    assert "A sample was graded, and nothing was found. (" in out
    assert "mistakes graded with seed 1" in err


def test_something_found(known: Tiny, capsys: pytest.CaptureFixture[str]) -> None:
    known.grader(high="got in (5, 6)")
    code, out, _ = run(capsys)
    assert code == 1
    assert "tiny.py, line 3: another number" in out
    assert "NOT PROVEN." in out


def test_ctrl_c_stops_it(known: Tiny, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **_more: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(proving, "prove_grader", interrupted)
    code, _, err = run(capsys, "--seed", "7")
    del known
    assert code == 130
    assert "course-kit: stopped." in err

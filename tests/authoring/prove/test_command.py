"""`course-kit prove` at a terminal: its exit codes, its JSON, its page, and Ctrl-C."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.authoring.prove import proving
from course_kit.cli import main
from course_kit.grading import exercise

if TYPE_CHECKING:
    from pathlib import Path

    from tests.authoring.prove.conftest import Tiny

ARGUMENTS = ("prove", "tiny", "--workers", "1", "--repeat", "0", "--seeds", "1", "--quick")


@pytest.fixture
def known(tiny: Tiny, monkeypatch: pytest.MonkeyPatch) -> Tiny:
    """The tiny exercise, where the command finds it."""
    task = exercise.load("tiny", tiny.folder / "exercises")
    monkeypatch.setattr(exercise, "load", lambda _: task)
    monkeypatch.setattr("course_kit.authoring.prove.places.of", lambda _: tiny.places)
    return tiny


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main.main([*ARGUMENTS, *arguments])
    shown = capsys.readouterr()
    return code, shown.out, shown.err


def test_nothing_found(known: Tiny, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    del known
    page = tmp_path / "proof.html"
    code, out, err = run(capsys, "--page", str(page))
    assert code == 0
    assert "A sample was graded, and nothing was found. (seed 1" in out
    assert "programs" in err
    assert f"The page is {page}" in err
    assert page.read_text().count('<tr id="line-') == 4


def test_something_found_as_json(known: Tiny, capsys: pytest.CaptureFixture[str]) -> None:
    known.grader(high="got in (5, 6)")
    code, out, _ = run(capsys, "--json")
    told = json.loads(out)
    assert code == 1
    assert (told["exercise"], told["proven"], told["quick"]) == ("tiny", False, True)
    assert [one["after"] for one in told["mutants"] if one["state"] == "survived"] == ['"high": 6,']


def test_what_cannot_be_tried(known: Tiny, capsys: pytest.CaptureFixture[str]) -> None:
    known.declare("[[equivalent]]\n")
    code, out, err = run(capsys)
    assert (code, out) == (2, "")
    assert "equivalent.toml cannot be used: entry 1 of [[equivalent]] has no 'lines'." in err


def test_ctrl_c_says_how_far_it_came_and_how_to_go_on(
    known: Tiny, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(proving, "prove", interrupted)
    code, _, err = run(capsys, "--seed", "7")
    del known
    assert code == 130
    assert f"{environment.command()} prove tiny --resume --quick --seed 7" in err
    assert "Stopped after 0 gradings" in err

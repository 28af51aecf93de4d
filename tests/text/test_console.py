"""What commands say to a person: on stderr, and in lines that fit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.text import console

if TYPE_CHECKING:
    import pytest


def test_a_sentence_is_said_beside_the_output_and_an_empty_one_is_not(capsys: pytest.CaptureFixture[str]) -> None:
    console.note("the disk is full.")
    console.note("")
    assert console.refuse(ValueError("there is no such file.")) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err == "course-kit: the disk is full.\ncourse-kit: there is no such file.\n"


def test_lines_break_between_words_and_not_within_an_option() -> None:
    text = "Repeat the hints that you have seen with --again-and-again."
    assert console.wrap_text(text, "1. ", "   ", width=50) == [
        "1. Repeat the hints that you have seen with",
        "   --again-and-again.",
    ]


def test_what_a_submission_says_does_not_steer_the_terminal() -> None:
    assert console.wrap_text("got \x1b[2Jnothing") == ["got \ufffd[2Jnothing"]

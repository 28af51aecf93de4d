"""How a command speaks to a person at a terminal: sentences on stderr, and lines of a width that fits."""

from __future__ import annotations

import sys
import textwrap

from course_kit.text.sanitize import make_printable

WIDTH = 80  # columns
CANNOT = 2  # the exit code of a command that could not be carried out


def note(sentence: object) -> None:
    """Say something beside the output of the command; an empty text says nothing."""
    if text := make_printable(str(sentence)):  # names of files and words of submissions may stand in it
        sys.stderr.write(f"course-kit: {text}\n")
        sys.stderr.flush()


def refuse(sentence: object) -> int:
    """Say why a command could not be carried out; its exit code."""
    note(sentence)
    return CANNOT


def wrap_text(
    text: str, first: str = "", following: str = "", *, width: int = WIDTH, whole_words: bool = False
) -> list[str]:
    """Text in lines, never broken at a hyphen (ids have some), and harmless for the terminal, whoever wrote it."""
    return textwrap.wrap(
        make_printable(text),
        width,
        initial_indent=first,
        subsequent_indent=following,
        break_on_hyphens=False,
        break_long_words=not whole_words,
    )


def in_points(amount: float) -> str:
    """`1 point`, `2.5 points`."""
    return f"{amount:g} point{'s' * (amount != 1)}"

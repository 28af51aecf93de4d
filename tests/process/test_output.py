"""What a child prints comes by lines, and its last words are kept."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit.process.child import LineReader, QuietChild

if TYPE_CHECKING:
    from collections.abc import Iterator


@pytest.fixture
def ends() -> Iterator[list[int]]:
    """Both ends of a pipe, for a test to close the second."""
    both = list(os.pipe())
    yield both
    for end in both:
        os.close(end)


def test_whole_lines_are_handed_on_and_nothing_is_waited_for(ends: list[int]) -> None:
    lines = LineReader(ends[0])
    assert lines.read() == []
    os.write(ends[1], b"one\ntwo\nhal")
    assert lines.read() == ["one", "two"]
    os.write(ends[1], b"f\n\xff\n\n")
    assert lines.read() == ["half", "\N{REPLACEMENT CHARACTER}", ""]
    assert not lines.ended


def test_a_full_pipe_is_taken_in_at_once(ends: list[int]) -> None:
    lines = LineReader(ends[0])
    os.set_blocking(ends[1], False)
    written = os.write(ends[1], b"line\n" * 100_000)
    assert 0 < written < 500_000
    assert len(lines.read()) == written // 5


def test_the_last_line_of_much_is_kept_and_asking_disturbs_nothing(ends: list[int]) -> None:
    program = "import os, sys\nprint('x\\n' * 10_000, flush=True)\nos.read(int(sys.argv[1]), 1)\nprint('the reason\\n')"
    child = QuietChild([sys.executable, "-c", program, str(ends[0])], [ends[0]])
    while child.last_line() != "x":
        assert child.exit_code() is None
    os.write(ends[1], b"!")
    assert child.wait(60) == 0
    assert child.last_line() == "the reason"
    assert child.wait_or_kill(60) == 0
    assert child.last_line() == ""

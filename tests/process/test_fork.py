"""A child that runs a function, and ends whatever that does."""

from __future__ import annotations

import os
import sys

import pytest

from course_kit.process.closing import Closing
from course_kit.process.fork import fork


def status_of(child: int) -> int:
    _, status = os.waitpid(child, 0)
    return os.waitstatus_to_exitcode(status)


def raises() -> None:
    raise LookupError("told on stderr")


def test_it_ends_after_the_function() -> None:
    reader, writer = os.pipe()
    child = fork(lambda: os.write(writer, b"done in the child"))
    os.close(writer)
    with os.fdopen(reader, "rb") as told:
        assert told.read() == b"done in the child"
    assert (status_of(child), child != os.getpid()) == (0, True)


def test_what_the_function_raises_ends_the_child_and_is_told(capfd: pytest.CaptureFixture[str]) -> None:
    assert status_of(fork(raises, failed=70)) == 70
    assert "LookupError: told on stderr" in capfd.readouterr().err


def test_a_function_that_wants_to_end_the_program_ends_the_child() -> None:
    assert status_of(fork(sys.exit, failed=70)) == 70


class Counted(Closing):
    def __init__(self) -> None:
        self.closed = 0

    def close(self) -> None:
        self.closed += 1


def test_the_end_of_a_with_closes() -> None:
    with Counted() as whole:
        assert whole.closed == 0
    broken = Counted()
    with pytest.raises(LookupError), broken:
        raise LookupError
    assert (whole.closed, broken.closed) == (1, 1)

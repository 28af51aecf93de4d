"""A child that runs a function, and ends whatever that does."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from course_kit.process.child import fork_child

if TYPE_CHECKING:
    import pytest


def status_of(child: int) -> int:
    _, status = os.waitpid(child, 0)
    return os.waitstatus_to_exitcode(status)


def raises() -> None:
    raise LookupError("told on stderr")


def test_it_ends_after_the_function() -> None:
    reader, writer = os.pipe()
    child = fork_child(lambda: os.write(writer, b"done in the child"))
    os.close(writer)
    with os.fdopen(reader, "rb") as told:
        assert told.read() == b"done in the child"
    assert (status_of(child), child != os.getpid()) == (0, True)


def test_what_the_function_raises_ends_the_child_and_is_told(capfd: pytest.CaptureFixture[str]) -> None:
    assert status_of(fork_child(raises)) == 1
    assert "LookupError: told on stderr" in capfd.readouterr().err

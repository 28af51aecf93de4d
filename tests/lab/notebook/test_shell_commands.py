"""What a program prints that ends at once, read by the real pexpect from a real child process."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pexpect

from course_kit.lab.notebook.cells import show_all_output
from course_kit.lab.overrides.patches import Patches

if TYPE_CHECKING:
    import pytest


def ends_between_two_looks(monkeypatch: pytest.MonkeyPatch) -> bytes:
    """What is read of a program that prints and ends after pexpect has looked for output, and before it looks again."""
    program: pexpect.spawn[bytes] = pexpect.spawn("sh", ["-c", "read word; echo the last $word"], echo=False)
    is_alive, looks = program.isalive, iter(("before it waits for output", "after it"))

    def is_alive_now() -> bool:
        if next(looks, "") == "after it":
            program.sendline("word")
            os.waitid(os.P_PID, program.pid, os.WEXITED | os.WNOWAIT)
        return is_alive()

    monkeypatch.setattr(program, "isalive", is_alive_now)
    while program.expect_list([pexpect.TIMEOUT, pexpect.EOF], timeout=0.05) == 0:
        pass  # as IPython does
    program.close()
    assert isinstance(program.before, bytes)
    return program.before


def test_what_a_program_prints_the_moment_it_ends_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    patches = Patches()
    show_all_output(patches)
    try:
        assert ends_between_two_looks(monkeypatch) == b"the last word\r\n"
    finally:
        patches.undo()

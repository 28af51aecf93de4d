"""A function of the C library that fails raises an error that says what has failed."""

from __future__ import annotations

import errno
import subprocess
import sys

import pytest

from course_kit.process import libc


def test_what_fails_says_what_it_was() -> None:
    with pytest.raises(OSError, match="close nothing: Bad file descriptor") as raised:
        libc.call_libc("close", -1, what="close nothing")
    assert raised.value.errno == errno.EBADF
    with pytest.raises(OSError, match="prctl NOTHING: Invalid argument"):
        libc.call_prctl(-1, what="NOTHING")
    with pytest.raises(OSError, match="no such call: Function not implemented"):
        libc.system_call(100_000, what="no such call")


def test_a_process_gets_a_name() -> None:
    program = "from course_kit.process.libc import set_name\nset_name('a plain name')\n"
    program += "print(open('/proc/self/comm').read())"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.strip() == "a plain name"

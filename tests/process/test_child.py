"""A child process: started apart from us, ended in steps, and never left behind."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
from signal import SIGINT, SIGKILL, SIGTERM
from typing import TYPE_CHECKING

import psutil
import pytest

from course_kit.process.child import INTO_STDOUT, PIPE, Child, Ladder, fork_child
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Callable

STUBBORN = """
import signal, subprocess, sys, time
for number in (signal.SIGINT, signal.SIGTERM):
    signal.signal(number, lambda number, _: print(signal.Signals(number).name, flush=True))
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
print(child.pid, flush=True)
while True:
    time.sleep(600)
"""
TALKATIVE = """
import signal, sys, time
def tell(*_):
    print("x" * 1_000_000)
    sys.exit(7)
signal.signal(signal.SIGINT, tell)
print("ready", flush=True)
time.sleep(600)
"""
LEAVING = """
import signal, subprocess, sys
signal.signal(signal.SIGINT, signal.SIG_IGN)  # which what it starts inherits
sleep = [sys.executable, "-c", "import time; time.sleep(600)"]
print(subprocess.Popen(sleep, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).pid, flush=True)
"""
DYING_WITH_US = """
import sys, time
from course_kit.process.child import Child
print(Child([sys.executable, "-c", "import time; time.sleep(600)"], dies_with_us=True).pid, flush=True)
time.sleep(600)
"""
ORPHAN = """
import os, sys
from course_kit.process.libc import die_with_parent
die_with_parent(int(sys.argv[1]))
print("lives")
"""


def start(program: str) -> tuple[Child, str]:
    """A child, and its first line."""
    child = Child([sys.executable, "-c", program], stdout=PIPE, stderr=INTO_STDOUT)
    assert child.stdout is not None
    return child, child.stdout.readline().decode().strip()


def is_alive(pid: int) -> bool:
    return psutil.pid_exists(pid) and psutil.Process(pid).status() != psutil.STATUS_ZOMBIE


def test_one_that_ignores_everything_is_killed_at_last_and_so_is_what_it_has_started() -> None:
    child, grandchild = start(STUBBORN)
    ladder = Ladder(0.3, 0.3, 10.0)
    child.end(ladder)
    assert [number for number, _ in ladder.climbed] == [SIGINT, SIGTERM, SIGKILL]
    assert child.exit_code() == -SIGKILL
    wait_until(lambda: not is_alive(int(grandchild)), "the end of the grandchild")


def test_what_it_prints_at_its_end_is_read_however_long_and_it_ends_as_it_likes() -> None:
    child, _ = start(TALKATIVE)
    ladder = Ladder(60.0, 0.0, 0.0)
    assert child.end(ladder) == b"x" * 1_000_000 + b"\n"
    assert child.exit_code() == 7
    assert [number for number, _ in ladder.climbed] == [SIGINT]


@pytest.mark.parametrize("end", [Child.kill, lambda child: child.end(Ladder(60.0, 0.0, 0.0))])
def test_what_it_leaves_behind_is_killed(end: Callable[[Child], object]) -> None:
    child, grandchild = start(LEAVING)
    assert child.wait(60) == 0
    assert is_alive(int(grandchild))
    end(child)
    wait_until(lambda: not is_alive(int(grandchild)), "the end of the grandchild")


def test_it_dies_with_us_where_it_is_to() -> None:
    with subprocess.Popen([sys.executable, "-c", DYING_WITH_US], stdout=subprocess.PIPE, text=True) as us:
        assert us.stdout is not None
        child = int(us.stdout.readline())
        assert is_alive(child)
        us.send_signal(signal.SIGKILL)
        wait_until(lambda: not is_alive(child), "the end of the child")


def test_one_whose_parent_has_ended_before_it_could_say_so_ends_at_once() -> None:
    def run(parent: int) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-c", ORPHAN, str(parent)]
        return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)

    assert run(os.getpid()).stdout == "lives\n"
    orphan = run(os.getppid())
    assert (orphan.returncode, orphan.stdout) == (-SIGKILL, "")


@pytest.mark.parametrize("seconds", [60.0, math.inf, None])
def test_the_end_of_a_child_is_waited_for(seconds: float | None) -> None:
    child = Child([sys.executable, "-c", "import sys; sys.exit(7)"])
    assert child.wait(seconds) == 7
    assert child.wait(seconds) == 7
    assert child.wait_or_kill(0.0) == 7


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

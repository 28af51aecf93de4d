"""Whose fault it is that a program waits for a processor: with figures made up, and with real programs."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import pytest

from course_kit.grading.sandbox import machine
from course_kit.grading.sandbox.machine import WaitTime
from course_kit.process import tree
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

PROGRAM, CHILD, OTHER_CHILD = 7, 8, 9
TICKS = os.sysconf("SC_CLK_TCK")
BUSY = "while True: pass"
BUSY_CHILDREN = (
    "import os, time\nfor _ in range(12):\n    if os.fork() == 0:\n        while True: pass\ntime.sleep(600)"
)


class MadeUpProc:
    """A /proc with what `WaitTime` reads in it, in seconds."""

    def __init__(self, root: Path) -> None:
        self._root = root
        (root / "self").symlink_to("1")
        self.started(100)

    def threads(self, process: int, **times: tuple[float, float]) -> None:
        """What the threads of a process have computed and waited for; a process has computed what its threads have."""
        for name, (computed, waited) in times.items():
            folder = self._root / str(process) / "task" / name
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "schedstat").write_text(f"{round(computed * 1e9)} {round(waited * 1e9)} 12\n")
        self.process(process, sum(computed for computed, _ in times.values()))

    def process(self, process: int, computed: float) -> None:
        (self._root / str(process)).mkdir(exist_ok=True)
        times = [0] * 11 + [round(computed * TICKS), 0]
        (self._root / str(process) / "stat").write_text(f"{process} (a) b c) {' '.join(map(str, times))}\n")

    def started(self, last: int) -> None:
        (self._root / "loadavg").write_text(f"1.0 1.0 1.0 3/20 {last}\n")


class Clock:
    """Seconds that are set."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def proc(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> MadeUpProc:
    monkeypatch.setattr(machine, "_PROC", str(tmp_path))
    return MadeUpProc(tmp_path)


def test_a_thread_that_others_keep_from_running_has_waited(proc: MadeUpProc) -> None:
    waiting = WaitTime(PROGRAM, with_children=False)
    proc.threads(PROGRAM, main=(1.0, 1.0), helper=(0.0, 0.0))
    assert waiting.look([PROGRAM], 2) == pytest.approx(1.0)
    proc.threads(PROGRAM, main=(1.5, 1.0), helper=(0.0, 0.5))  # now another one
    assert waiting.look([PROGRAM], 2) == pytest.approx(1.0)
    proc.threads(PROGRAM, main=(1.5, 1.0), helper=(0.0, 0.9))
    assert waiting.look([PROGRAM], 2) == pytest.approx(1.4)


def test_threads_that_stand_in_each_others_way_have_not_waited(proc: MadeUpProc) -> None:
    waiting = WaitTime(PROGRAM, with_children=False)
    proc.threads(PROGRAM, **{f"t{number}": (1.0, 3.0) for number in range(4)})
    assert waiting.look([PROGRAM], 4) == 0.0


def test_a_program_whose_children_have_the_processors_has_not_waited(proc: MadeUpProc) -> None:
    clock = Clock()
    waiting = WaitTime(PROGRAM, with_children=False, clock=clock, processors=2)
    proc.threads(PROGRAM, main=(0.2, 3.0))
    proc.process(CHILD, 2.0)
    proc.process(OTHER_CHILD, 2.0)
    clock.now = 2.0
    assert waiting.look([PROGRAM, CHILD, OTHER_CHILD], 3) == 0.0


def test_children_wait_for_nothing_that_counts(proc: MadeUpProc) -> None:
    for with_children, seconds in ((False, 0.0), (True, 3.0)):
        waiting = WaitTime(PROGRAM, with_children=with_children)
        proc.threads(PROGRAM, main=(0.0, 0.0))
        proc.threads(CHILD, only=(0.0, 3.0))
        assert waiting.look([PROGRAM, CHILD], 2) == pytest.approx(seconds)


def test_what_has_ended_has_computed_all_the_same(proc: MadeUpProc) -> None:
    waiting = WaitTime(PROGRAM, with_children=False)
    proc.threads(PROGRAM, main=(0.0, 2.0))
    proc.process(PROGRAM, 2.0)
    assert waiting.look([PROGRAM], 1) == pytest.approx(0.0)


def test_while_children_may_have_had_the_processors_unseen_nothing_counts(proc: MadeUpProc) -> None:
    clock = Clock()
    waiting = WaitTime(PROGRAM, with_children=True, clock=clock, processors=2)
    proc.threads(PROGRAM, main=(0.0, 1.0))
    proc.process(CHILD, 0.0)
    assert waiting.look([PROGRAM, CHILD], 20) == pytest.approx(1.0)
    proc.started(101)  # one, and no more than before are there
    clock.now = 1.0
    waiting.notice([PROGRAM, CHILD], 20)
    assert waiting.hidden_s == pytest.approx(2.0)
    proc.threads(PROGRAM, main=(0.0, 2.0))
    assert waiting.look([PROGRAM, CHILD], 20) == pytest.approx(1.0)
    proc.threads(PROGRAM, main=(0.0, 3.0))
    proc.started(131)
    clock.now = 3.0
    assert waiting.look([PROGRAM, CHILD], 50) == pytest.approx(2.0)  # thirty, and they are there
    assert waiting.hidden_s == pytest.approx(2.0)


@pytest.fixture
def start() -> Iterator[Callable[[str], int]]:
    """Starts programs in sessions of their own, on one processor together."""
    started: list[subprocess.Popen[bytes]] = []
    processor = min(os.sched_getaffinity(0))

    def run(source: str) -> int:
        program = subprocess.Popen([sys.executable, "-S", "-c", source], start_new_session=True)
        started.append(program)
        os.sched_setaffinity(program.pid, {processor})
        return program.pid

    yield run
    for program in started:
        os.killpg(program.pid, 9)
        program.wait()


def seconds_of(program: int) -> float:
    return machine._cpu_s(program)


def test_a_real_program_that_shares_its_processor_has_waited(start: Callable[[str], int]) -> None:
    program, _ = start(BUSY), [start(BUSY) for _ in range(2)]
    waiting = WaitTime(program, with_children=False)
    waiting.look([program], 1)
    began, before = time.monotonic(), waiting.seconds
    wait_until(lambda: waiting.look([program], 1) - before > 1.0, "a second of waiting")
    assert waiting.seconds - before < time.monotonic() - began


def test_a_real_program_that_sleeps_has_not_however_busy_its_children_are(start: Callable[[str], int]) -> None:
    program = start(BUSY_CHILDREN)
    wait_until(lambda: len(tree.descendants_of(program)) == 12, "the children")
    waiting = WaitTime(program, with_children=False)

    def busy() -> float:
        everything = [program, *tree.descendants_of(program)]
        waiting.look(everything, len(everything))
        return sum(map(seconds_of, everything))

    before, had, somebody = busy(), waiting.seconds, machine.somebody_waited()
    wait_until(lambda: busy() - before > 1.0, "a second of computing")
    assert waiting.seconds - had < 0.2
    assert machine.somebody_waited() > somebody or not somebody  # 0 where the kernel does not count it

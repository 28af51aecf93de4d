"""The process next to the submission: counts what it uses, stops it at its limits, tells how it ended.

It is process 1 of the submission's PID namespace (see `sandbox`), runs only the kit's code, and holds nothing
worth stealing: what it tells serves the diagnosis, never the points.
"""

from __future__ import annotations

import os
import select
import signal
import time
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.grading.sandbox import file_view, machine, namespaces, runner
from course_kit.grading.sandbox.machine import WaitTime, last_task
from course_kit.process import tree
from course_kit.process.child import fork_child
from course_kit.process.libc import adopt_orphans, die_with_parent, set_name

if TYPE_CHECKING:
    from course_kit.grading.model.plain_data import Record
    from course_kit.grading.sandbox.start_order import StartOrder, Streams

SAMPLE = b"m"
STACKS, KILL = b"s", b"k"  # behind them may stand the name of the file that the process runs
_PERIOD_S = 0.05
_PATIENCE_S = 0.2  # for an exact count of memory, during which processes are not counted
_STARTED_AT_ONCE, _STARTED_PER_S = 512, 200  # processes and threads: who starts more makes everybody wait
_MB = 1024 * 1024
_LONGEST_NAME = 15  # characters that the kernel keeps of a process's name


def main(order: StartOrder, inside: Streams) -> None:
    """Arrange the files, start the program, watch it, and end when it has ended."""
    set_name("grade init")
    die_with_parent()
    adopt_orphans()
    if order.isolation.files:
        try:
            file_view.lay_out(order.view, order.scratch, 2 * order.limits.file_mb, order.user)
        except OSError as problem:  # it worked when it was tried out: the machine has run out of something
            inside.tell(problem=f"the sandbox cannot be arranged: {problem}")
            return
    child = fork_child(partial(runner.main, order, inside))
    namespaces.forbid_tracing()
    for end in (inside.stdout, inside.stderr, inside.evidence):
        os.close(end)
    _Watch(child, order, inside).until_end()
    if not order.isolation.processes:
        tree.end_descendants()
    os._exit(0)


class _Watch:
    def __init__(self, child: int, order: StartOrder, inside: Streams) -> None:
        self._child = child
        self._together = order.program.launches  # the kernel counts the computing of each process alone
        self._limits = order.limits
        self._own_network = order.isolation.network
        self._inside = inside
        self._waiting = WaitTime(child, with_children=self._together or bool(order.program.command))
        self._root = tree.this_process()
        self._began = time.monotonic()
        self._computed_before = sum(os.times()[:2])
        self._known: list[int] = []  # what was there when the task `_last` was the latest that had been started
        self._last = 0

    def until_end(self) -> None:
        poll = select.poll()
        poll.register(self._inside.control, select.POLLIN)
        # Not SIGCHLD: a program that floods this process with it would make others wait. Its orphans can.
        with suppress(OSError, AttributeError):  # a kernel before 5.3, a Python built for one: the period has to do
            poll.register(os.pidfd_open(self._child), select.POLLIN)
        while True:
            events = dict(poll.poll(_PERIOD_S * 1000))
            code = self._reap()
            if code is not None:
                end: Record = {"exit_code": code} if code >= 0 else {"signal": -code}
                if code == -signal.SIGXCPU:
                    end["limit"] = "time"
                self._inside.tell(**self._usage(), **end)
                return
            if self._inside.control in events and not self._obey():
                return
            if limit := self._exceeded_limit():
                self._inside.tell(**self._usage(), limit=limit)
                return

    def _reap(self) -> int | None:
        """The exit code of the program when it has ended; orphans it has left are reaped on the way."""
        with suppress(ChildProcessError):
            while (ended := os.waitpid(-1, os.WNOHANG))[0]:
                if ended[0] == self._child:
                    return os.waitstatus_to_exitcode(ended[1])
        return None

    def _obey(self) -> bool:
        wishes = os.read(self._inside.control, 4096)
        if not wishes:  # the grader has gone
            return False
        for wish in wishes.splitlines():
            if wish[:1] in (STACKS, KILL):
                number = runner.STACKS_SIGNAL if wish[:1] == STACKS else signal.SIGKILL
                chosen = [self._child]
                if name := wish[1:].decode():
                    chosen = [each for each in self._started_processes() if each != self._child and _runs(each, name)]
                for process_id in chosen:
                    with suppress(OSError):  # it has ended
                        os.kill(process_id, number)
        self._inside.tell(**self._usage())
        return True

    def _exceeded_limit(self) -> str:
        everything = self._started_processes()
        if len(everything) > self._limits.tasks:  # a program that forks without end outruns any closer look
            return "processes"
        if self._last > _STARTED_AT_ONCE + _STARTED_PER_S * (time.monotonic() - self._began):
            return "processes"
        usage = tree.measure_usage(everything)
        self._waiting.notice(everything, usage.tasks)
        if self._together and usage.cpu_s > self._limits.cpu_s:
            return "time"
        if usage.tasks > self._limits.tasks:
            return "processes"
        # Pages, their tables, what was swapped out and sockets: roughly first, then exactly.
        room = self._limits.memory_mb * _MB - (machine.bytes_of_sockets() if self._own_network else 0)
        too_much = usage.memory + usage.tables > room and machine.measure_memory(everything, _PATIENCE_S) > room
        return "memory" if too_much else ""

    def _started_processes(self) -> list[int]:
        """All the program has started; process 1 of a PID namespace sees nothing else."""
        if self._root != 1:
            return tree.descendants_of(self._root)
        last = last_task()  # first: what is started while they are listed is listed again the next time
        if last != self._last or not last:
            self._known, self._last = tree.all_but(1), last
        return self._known

    def _usage(self) -> Record:
        everything = self._started_processes()
        usage = tree.measure_usage(everything)
        waited_s = self._waiting.look(everything, usage.tasks)
        own = os.times()  # what watching costs is the submission's: it decides how often there is something to see
        cpu_s = usage.cpu_s + own.user + own.system - self._computed_before
        return {"cpu_s": cpu_s, "waited_s": waited_s, "hidden_s": self._waiting.hidden_s}


def _runs(process_id: int, name: str) -> bool:
    """Whether a process runs a file: it is named so, see `runner`, or is the Python that was started with it."""
    with suppress(OSError):
        called = Path(f"/proc/{process_id}/comm").read_text(errors="replace").rstrip("\n")
        words = Path(f"/proc/{process_id}/cmdline").read_text(errors="replace").split("\0")
        return called == name[:_LONGEST_NAME] or name in (Path(word).name for word in words[:3])
    return False

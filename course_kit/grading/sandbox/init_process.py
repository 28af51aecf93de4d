"""The process next to the submission: counts what it uses, stops it at its limits, tells how it ended.

It is process 1 of the submission's PID namespace (see `sandbox`), runs only the kit's code, and holds nothing
worth stealing: what it tells serves the diagnosis, never the points.
"""

from __future__ import annotations

import os
import select
import signal
from contextlib import suppress
from typing import TYPE_CHECKING

from course_kit.grading.sandbox import memory, namespaces, runner, socket_memory
from course_kit.grading.sandbox.isolation import arrange_files
from course_kit.grading.sandbox.scheduling import Waiting, last_task
from course_kit.process import tree
from course_kit.process.parent import adopt_orphans, die_with_parent, set_name

if TYPE_CHECKING:
    from course_kit.grading.plain_data import Record
    from course_kit.grading.sandbox.runner import Program
    from course_kit.grading.sandbox.sandbox import Conditions, Streams

FAILED = 70  # the exit status of a kit process that could not do its work (EX_SOFTWARE)
SAMPLE = b"m"
STACKS = b"s"
_PERIOD_S = 0.05
_PATIENCE_S = 0.2  # for an exact count of memory, during which processes are not counted
_MB = 1024 * 1024


def main(program: Program, cell: Conditions, inside: Streams) -> None:
    """Arrange the files, start the program, watch it, and end when it has ended."""
    set_name("grade init")
    die_with_parent()
    adopt_orphans()
    if cell.isolation.files:
        try:
            arrange_files(cell.view, cell.scratch, 2 * cell.limits.file_mb, cell.user)
        except OSError as problem:  # it worked when it was tried out: the machine has run out of something
            inside.tell(problem=f"the sandbox cannot be arranged: {problem}")
            return
    reader, writer = os.pipe()
    for end in (reader, writer):
        os.set_blocking(end, False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)
    starting, arranged = os.pipe()
    os.set_blocking(starting, False)
    child = os.fork()
    if child == 0:
        try:
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            runner.main(program, cell, inside)
        finally:
            os._exit(FAILED)
    namespaces.forbid_tracing()
    for end in (inside.stdout, inside.stderr, inside.evidence, arranged):
        os.close(end)
    waiting = Waiting(child, with_children=bool(program.command))
    _Watch(child, cell, inside, waiting, starting).until_end(reader)
    if not cell.isolation.processes:
        tree.end_descendants()
    os._exit(0)


class _Watch:
    def __init__(self, child: int, cell: Conditions, inside: Streams, waiting: Waiting, starting: int) -> None:
        """Watch a program."""
        self._child = child
        self._limits = cell.limits
        self._own_network = cell.isolation.network
        self._inside = inside
        self._waiting = waiting
        self._starting = starting
        self._root = tree.this_process()
        self._known: list[int] = []  # what was there when the task `_last` was the latest that had been started
        self._last = 0
        self._held, self._held_at = memory.Held(), -1.0  # by descriptors, and what had been computed then

    def until_end(self, wakeup: int) -> None:
        poll = select.poll()
        poll.register(self._inside.control, select.POLLIN)
        poll.register(wakeup, select.POLLIN)
        while True:
            events = dict(poll.poll(_PERIOD_S * 1000))
            if wakeup in events:
                with suppress(BlockingIOError):
                    os.read(wakeup, 4096)
            ended = self._reap()
            if ended is not None:
                self._inside.tell(**self._usage(), **_how(ended))
                return
            if self._inside.control in events and not self._obey():
                return
            if limit := self._exceeded():
                self._inside.tell(**self._usage(), limit=limit)
                return

    def _reap(self) -> int | None:
        """The wait status of the program when it has ended; orphans it has left are reaped on the way."""
        with suppress(ChildProcessError):
            while True:
                process_id, status = os.waitpid(-1, os.WNOHANG)
                if process_id == self._child:
                    return status
                if process_id == 0:
                    break
        return None

    def _obey(self) -> bool:
        wishes = os.read(self._inside.control, 64)
        if not wishes:  # the grader has gone
            return False
        if STACKS in wishes:
            with suppress(ProcessLookupError):
                os.kill(self._child, runner.STACKS_SIGNAL)
        self._inside.tell(**self._usage())
        return True

    def _exceeded(self) -> str:
        everything = self._everything()
        if len(everything) > self._limits.tasks:  # a program that forks without end outruns any closer look
            return "processes"
        usage = tree.usage(everything)
        self._waiting.notice(everything, usage.tasks)
        if usage.tasks > self._limits.tasks:
            return "processes"
        return "memory" if self._takes_too_much(everything, usage) else ""

    def _takes_too_much(self, everything: list[int], usage: tree.Usage) -> bool:
        allowed = self._limits.memory_mb * _MB
        files, sockets, hidden = self._what_is_held(everything, usage.cpu_s)
        if hidden:
            return True
        if usage.memory + files + socket_memory.at_most(sockets) <= allowed:
            return False
        in_sockets = socket_memory.in_use(sockets) if self._own_network else socket_memory.of_others(sockets)
        return memory.exact_use(everything, files, _PATIENCE_S) + in_sockets > allowed

    def _what_is_held(self, everything: list[int], computed: float) -> memory.Held:
        """What takes memory without being mapped; a program that has not computed meanwhile has not changed it."""
        if computed != self._held_at:
            started = self._has_started()  # first: until then its process hides as the grader's own do
            held = memory.held(everything, _PATIENCE_S)
            sockets = socket_memory.number_here() if self._own_network else held.sockets
            self._held = held._replace(sockets=sockets, hidden=held.hidden and started)
            self._held_at = computed
        return self._held

    def _has_started(self) -> bool:
        if self._starting >= 0:
            with suppress(BlockingIOError):
                os.read(self._starting, 1)
                os.close(self._starting)
                self._starting = -1
        return self._starting < 0

    def _everything(self) -> list[int]:
        """All the program has started; process 1 of a PID namespace sees nothing else.

        Listing them anew takes longer than all else that is looked at here, and most programs are one process.
        """
        if self._root != 1:
            return tree.descendants(self._root)
        last = last_task()  # first: what is started while they are listed is listed again the next time
        if last != self._last or not last:
            self._known, self._last = tree.all_but(1), last
        return self._known

    def _usage(self) -> Record:
        everything = self._everything()
        usage = tree.usage(everything)
        waited_s = self._waiting.look(everything, usage.tasks)
        times = {"cpu_s": usage.cpu_s, "waited_s": waited_s, "hidden_s": self._waiting.hidden_s}
        return {**times, "tasks": usage.tasks, "memory": usage.memory}


def _how(status: int) -> Record:
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        return {"signal": number, **({"limit": "time"} if number == signal.SIGXCPU else {})}
    return {"exit_code": os.WEXITSTATUS(status)}

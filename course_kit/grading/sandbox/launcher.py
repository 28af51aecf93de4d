"""Where submissions are started: a process that has everything loaded and knows no secret.

A submission is a fork of it and can read what it has ever held in memory. So it receives orders of one word,
descriptors, and names of interfaces to load; the fork reads the program to run, and nothing else of the grading.

Between it and the program are two processes: one enters the namespaces and waits; the *init process*, process 1 of
the new PID namespace, arranges the files, counts, and enforces what the kernel does not (see `init_process`).
"""

from __future__ import annotations

import gc
import json
import os
import signal
import socket
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

import msgspec

from course_kit.grading.model.plain_data import convert_record
from course_kit.grading.sandbox import init_process, namespaces
from course_kit.grading.sandbox.start_order import StartOrder, Streams
from course_kit.interfaces import get_type
from course_kit.process import Closable, tree
from course_kit.process.child import fork_child, freeze_memory
from course_kit.process.libc import adopt_orphans, die_with_parent, make_memory_file, set_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

_END, _ENDED = b"end", b"ended"  # all other orders are names of interfaces: start a program
_LARGEST_ORDER = 16 * 1024  # bytes
_MOST_DESCRIPTORS = 16
_REQUEST, _STREAMS, _NAMESPACES = 0, slice(1, 6), slice(6, 8)  # of the descriptors of an order to start
_ENDING_S = 30.0  # killing is quick, also of hundreds of processes


class Launcher(Closable):
    """The process, seen from the supervisor of a grading. One submission at a time; OSError when it has gone."""

    def __init__(self) -> None:
        """Make a line to it; the other end is for the process itself."""
        self._line, self.other_end = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)

    def start(self, order: StartOrder, inside: Streams, network: Sequence[int], interfaces: Sequence[str]) -> None:
        """Start a program, which then need not load these interfaces; returns when it has been handed over."""
        with open(make_memory_file("start order"), "w+b", buffering=0) as request:  # noqa: PTH123 - a descriptor
            request.write(json.dumps(order, default=msgspec.to_builtins).encode())
            names = json.dumps(interfaces).encode()
            socket.send_fds(self._line, [names], [request.fileno(), *inside.descriptors(), *network])

    def end(self) -> None:
        """Kill all that was started; returns when it is dead."""
        self._line.settimeout(_ENDING_S)
        self._line.send(_END)
        if self._line.recv(len(_ENDED)) != _ENDED:
            raise ConnectionError("the process that starts programs was killed")

    def close(self) -> None:
        """Close this end; the process ends, with all it has started, when every copy is closed."""
        self._line.close()


def load_interfaces(names: Iterable[str]) -> None:
    """Load interfaces, so that no fork of this process need do it."""
    from rclpy.type_support import check_for_type_support

    for name in names:
        with suppress(Exception):  # the submission meets it again when it imports it, and gets the error then
            check_for_type_support(get_type(name))


def serve(line: socket.socket, interfaces: Iterable[str]) -> None:
    """The process, into which these interfaces were loaded: obey until the other end closes."""
    os.setsid()  # as each worker, see there: what a sandbox takes to be made is not to wait for that of all others
    set_name("grade launcher")
    adopt_orphans()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    loaded = set(interfaces)
    while True:
        order, descriptors, _, _ = socket.recv_fds(line, _LARGEST_ORDER, _MOST_DESCRIPTORS)
        if order in (_END, b""):
            tree.end_descendants()
            if not order:
                return
            with suppress(OSError):
                line.send(_ENDED)
        else:
            if new := set(json.loads(order)) - loaded:
                load_interfaces(new)
                freeze_memory()
                loaded |= new
            fork_child(partial(_gate, line, descriptors))
            for descriptor in descriptors:
                os.close(descriptor)


def _gate(line: socket.socket, descriptors: Sequence[int]) -> None:
    line.close()
    gc.disable()  # a collection would copy pages; the program has it again
    set_name("grade enter")
    die_with_parent()
    inside = Streams(*descriptors[_STREAMS])
    with open(descriptors[_REQUEST], "rb") as file:  # noqa: PTH123 - a descriptor
        file.seek(0)
        order = convert_record(json.load(file), StartOrder)
    try:
        if network := descriptors[_NAMESPACES]:
            namespaces.join(*network)
            for descriptor in network:
                os.close(descriptor)
        if order.isolation.processes:
            namespaces.enter_processes(order.user)
    except OSError as problem:  # it worked when it was tried out: the machine has run out of something
        inside.tell(problem=f"the sandbox cannot be entered: {problem}")
        return
    die_with_parent()  # entering a user namespace has cleared it
    child = fork_child(partial(init_process.main, order, inside))
    inside.close()
    os.waitpid(child, 0)

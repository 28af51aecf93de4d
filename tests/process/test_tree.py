"""All that a process has started is found and ended."""

from __future__ import annotations

import os
import threading
import time

from course_kit.process import tree
from course_kit.process.libc import adopt_orphans


def test_everything_below_is_ended() -> None:
    """In a process of its own, for it ends all its children: three generations of them."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.write(writer, family())
        finally:
            os._exit(0)
    os.close(writer)
    os.waitpid(child, 0)
    with os.fdopen(reader, "rb") as told:
        assert told.read() == b"gone"


def family() -> bytes:
    adopt_orphans()
    for deep in (2, 0):
        sleeper(deep)
    ready = threading.Event()
    while len(tree.descendants_of(os.getpid())) < 3 + 1:
        ready.wait(0.01)
    tree.end_descendants()
    return repr(tree.descendants_of(os.getpid())).encode().replace(b"[]", b"gone")


def sleeper(deep: int) -> int:
    """A process that waits, with `deep` more below it in a row."""
    child = os.fork()
    if child == 0:
        if deep:
            sleeper(deep - 1)
        time.sleep(600)
        os._exit(0)
    return child

"""All that a process has started is found and ended."""

from __future__ import annotations

import os
import threading
import time

from course_kit.process import tree
from course_kit.process.libc import adopt_orphans


def test_everything_below_is_ended_and_what_is_kept_lives() -> None:
    """In a process of its own, for it ends all its children: two generations of them, and one that is kept."""
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
        assert told.read() == b"kept lives, others are gone"


def family() -> bytes:

    adopt_orphans()
    kept = sleeper(0)
    others = [sleeper(2), sleeper(0)]
    ready = threading.Event()
    while len(tree.descendants_of(os.getpid())) < 1 + 3 + 1:
        ready.wait(0.01)
    below = tree.descendants_of(os.getpid())
    tree.end_descendants({kept})
    left = [one for one in below if tree.measure_usage([one]).tasks]
    tree.end_descendants()
    gone = tree.descendants_of(os.getpid()) == []
    return b"kept lives, others are gone" if left == [kept] and others and gone else repr((kept, below, left)).encode()


def sleeper(deep: int) -> int:
    """A process that waits, with `deep` more below it in a row."""
    child = os.fork()
    if child == 0:
        if deep:
            sleeper(deep - 1)
        time.sleep(600)
        os._exit(0)
    return child

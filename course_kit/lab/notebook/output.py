"""What callbacks print and log, in order, for whoever shows it.

Callbacks run on the lab's thread, and a notebook files a thread's output under whatever cell happens to run. So
the lab's thread puts its lines into one queue, and the notebook's main thread empties it: before it prints
something itself, when a call returns, and at the end of a cell. In a plain program lines are written at once.
"""

from __future__ import annotations

import contextvars
import sys
import threading
from collections import deque
from itertools import groupby
from operator import itemgetter
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Callable

Stream = Literal["stdout", "stderr"]
_PATIENCE = 1.0  # seconds for another thread to write what it has taken
_KEPT = 10_000  # lines, the latest, should nobody empty the queue for long


class Output:
    """The queue between callbacks and the notebook."""

    def __init__(self) -> None:
        self.queued = False
        self.pumps: list[Callable[[], None]] = []
        self.on_put: Callable[[], None] = lambda: None
        self.cell = contextvars.Context()  # of the running cell, or the latest: ipykernel writes under it
        self.producers: set[int] = set()
        self._lines: deque[tuple[Stream, str]] = deque(maxlen=_KEPT)
        self._parts: dict[tuple[int, Stream], str] = {}
        self._parting = threading.Lock()
        self._draining = threading.Lock()
        self._drainer: int | None = None
        self._news = threading.Event()

    def put(self, text: str, stream: Stream = "stdout") -> None:
        """Queue text, or write it where nothing is queued."""
        if not self.queued:
            self._write(stream, text)
            return
        self._lines.append((stream, text))
        self._news.set()
        self.on_put()

    def put_part(self, text: str, stream: Stream) -> None:
        """Queue text as soon as its line is complete, so that a line is never torn apart by somebody else's."""
        key = (threading.get_ident(), stream)
        with self._parting:
            text = self._parts.pop(key, "") + text
            if not text.endswith("\n"):
                self._parts[key] = text
                return
        self.put(text, stream)

    def end_parts(self) -> None:
        """Queue what has no line end yet; called at the end of a cell."""
        with self._parting:
            parts, self._parts = self._parts, {}
        for (_, stream), text in parts.items():
            self.put(text, stream)

    def poke(self) -> None:
        self._news.set()

    def wait(self, timeout: float) -> None:
        """Return when something was put, or after `timeout` seconds."""
        self._news.wait(timeout)

    def drain(self) -> None:
        """Write everything queued, on the calling thread, unless that is one of the producers."""
        me = threading.get_ident()
        if me in self.producers or me == self._drainer:  # called by our own print
            return
        if not self._draining.acquire(timeout=_PATIENCE):
            return
        try:
            self._drainer = me
            self._news.clear()
            for pump in self.pumps:
                pump()
            if threading.current_thread() is threading.main_thread():
                self._write_queued()
            else:
                self.cell.copy().run(self._write_queued)
        finally:
            self._drainer = None
            self._draining.release()

    def _write_queued(self) -> None:
        # What it has now: a callback that never stops may put more meanwhile.
        lines = [self._lines.popleft() for _ in range(len(self._lines))]
        for stream, those in groupby(lines, itemgetter(0)):
            self._write(stream, "".join(text for _, text in those))

    @staticmethod
    def _write(stream: Stream, text: str) -> None:
        if stream == "stderr":
            sys.stdout.flush()  # the two are shown in the order they were written in only if flushed in turn
        target = getattr(sys, stream)
        target.write(text)
        target.flush()

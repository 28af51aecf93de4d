"""How a run goes, for a person: one line that is written over on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import time
from collections import Counter
from typing import IO, TYPE_CHECKING

from course_kit.classroom.gradebook import outcome

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.classroom.records import Record

_ORDER = ("passed", "not passed", "crashed", "unreadable", "error")
_EVERY_S = 10.0  # between two lines where lines cannot be written over
_TOO_EARLY = 3  # results before an estimate is worth anything
_MINUTE = 60


class RunProgress:
    """Counts, estimates and prints."""

    def __init__(self, stream: IO[str], clock: Callable[[], float] = time.monotonic) -> None:
        """Print to `stream`; `clock` gives seconds."""
        self._stream = stream
        self._clock = clock
        self._live = stream.isatty()
        self._counts: Counter[str] = Counter()
        self._total = self._before = self._now = 0
        self._began = self._shown = clock()

    def begin(self, total: int, ready: Sequence[Record]) -> None:
        """See `run.Watcher`."""
        self._total, self._before = total, len(ready)
        self._counts.update(outcome(record) for record in ready)
        self._began = self._clock()
        known = f", {len(ready)} of them already have a result from an earlier run" if ready else ""
        self._print(f"{total} submission{'s' * (total != 1)}{known}.")

    def done(self, record: Record) -> None:
        """See `run.Watcher`."""
        self._now += 1
        self._counts[outcome(record)] += 1

    def tick(self) -> None:
        """See `run.Watcher`."""
        now = self._clock()
        if self._live:
            self._stream.write(f"\r\x1b[K{self.line()}")
            self._stream.flush()
        elif now - self._shown >= _EVERY_S:
            self._shown = now
            self._print(self.line())

    def stopping(self, under_way: int) -> None:
        """See `run.Watcher`."""
        self._print(f"Stopping once {under_way} running gradings have finished. Press Ctrl-C again to abandon them.")

    def end(self) -> None:
        """Leave the last state standing."""
        self._print(self.line())

    def line(self) -> str:
        """`[ 37/300] 20 passed, 12 not passed; about 1 min 20 s left`."""
        count = self._before + self._now
        width = len(str(self._total))
        counts = ", ".join(f"{self._counts[name]} {name}" for name in _ORDER if self._counts[name])
        return f"[{count:>{width}}/{self._total}]{' ' if counts else ''}{counts}{self._left(count)}"

    def _left(self, count: int) -> str:
        if self._now < _TOO_EARLY or count >= self._total:
            return ""
        seconds = round((self._total - count) * (self._clock() - self._began) / self._now)
        minutes, rest = divmod(seconds, _MINUTE)
        return f"; about {f'{minutes} min ' if minutes else ''}{rest} s left"

    def _print(self, line: str) -> None:
        self._stream.write(f"\r\x1b[K{line}\n" if self._live else f"{line}\n")
        self._stream.flush()

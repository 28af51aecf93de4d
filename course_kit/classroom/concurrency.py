"""Gradings take turns: so many side by side as keep the processors busy, and no more.

A submission that is silent, or asleep, or has got into a loop without end holds a worker for seconds, and keeps at most
one processor busy. While processors idle, its place is lent to another, and more gradings are begun than usual. On a
busy machine it stays at the usual number. Where most gradings wait, as those of a robot that drives do, processors idle
with many of them: then more are begun still.
"""

from __future__ import annotations

import statistics
import threading
import time
from collections import deque
from concurrent.futures import Future
from enum import IntEnum
from typing import TYPE_CHECKING, TypeVar

from course_kit.grading.sandbox.machine import processor_times

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from course_kit.grading.engine import GradingRequest
    from course_kit.grading.model.report import Report

Thing = TypeVar("Thing")
_AT_FIRST = 2  # times the usual number: a program that has just begun mostly waits to be discovered
_LOOK_S = 0.25  # over which it is seen whether processors idle
_IDLE, _BUSY = 0.2, 0.1  # share of the processors' time that was idle: above, more at a time; below, one less
_URGENT_EVERY = 3  # place
_WAITING_EVERY = 4  # of these
_STARTED_S = 0.5  # after which the workers have started, so that what idles is not waiting for them
_LENT_AFTER_S = 1.5  # a grading that takes longer mostly waits; its place is lent unless processors are busy
_REMEMBERED = 50  # gradings that have ended


class Urgency(IntEnum):
    """What may last begins early, so that nothing waits for it at the end."""

    LOOPS = 0
    WAITS = 1
    NONE = 2


def put_urgent_early(things: Iterable[Thing], urgency: Callable[[Thing], Urgency]) -> list[Thing]:
    """The things with the urgent ones early, as long as there are any; otherwise in their order."""
    by_urgency: dict[Urgency, deque[Thing]] = {one: deque() for one in Urgency}
    for thing in things:
        by_urgency[urgency(thing)].append(thing)
    loops, waits, others = (by_urgency[one] for one in Urgency)
    urgent = _every(_WAITING_EVERY, waits, loops, first=_WAITING_EVERY - 1)
    return list(_every(_URGENT_EVERY, urgent, others, first=0))


def _every(nth: int, some: deque[Thing], others: deque[Thing], *, first: int) -> deque[Thing]:
    """Both in their order, some of the first kind at every nth place from the first on, until one has no more."""
    order: deque[Thing] = deque()
    while some or others:
        turn = some if some and (len(order) % nth == first or not others) else others
        order.append(turn.popleft())
    return order


class GradingQueue:
    """Threads that take requests in the order they come, when it is their turn."""

    def __init__(
        self,
        grade: Callable[[GradingRequest], Report],
        usual: int,
        most: int,
        idle: Callable[[], float] | None = None,
        *,
        most_that_wait: int = 0,
    ) -> None:
        self._grade = grade
        self._usual, self._most, self._most_that_wait = usual, most, max(most, most_that_wait)
        self._idle = idle or IdleShare()
        self._waiting: deque[tuple[Future[Report], GradingRequest]] = deque()
        self._changed = threading.Condition()
        self._took: deque[float] = deque(maxlen=_REMEMBERED)  # seconds that gradings have taken
        self._begun: dict[int, float] = {}  # of what is under way, by thread: when it has begun
        self._allowed = min(_AT_FIRST * usual, most)
        self._idle_share = 0.0
        self._looked: float | None = None  # not at once: workers may still be starting
        self._ended = False
        self._threads = [
            threading.Thread(target=self._work, name=f"grading {place}") for place in range(self._most_that_wait)
        ]
        for thread in self._threads:
            thread.start()

    def submit(self, request: GradingRequest) -> Future[Report]:
        """Have a submission graded; the future can be cancelled until its turn comes."""
        future: Future[Report] = Future()
        with self._changed:
            self._waiting.append((future, request))
            self._changed.notify()
        return future

    def end(self) -> None:
        """Begin no more, and cancel what has not begun."""
        with self._changed:
            self._ended = True
            for future, _ in self._waiting:
                future.cancel()
            self._changed.notify_all()

    def join(self) -> None:
        """After `end`: wait for what is under way."""
        for thread in self._threads:
            thread.join()

    def _work(self) -> None:
        while (following := self._next()) is not None:
            future, request = following
            if future.set_running_or_notify_cancel():
                try:
                    report = self._grade(request)
                except BaseException as problem:  # noqa: BLE001 - whoever asks for the result meets it
                    future.set_exception(problem)
                else:
                    future.set_result(report)
            self._done()

    def _next(self) -> tuple[Future[Report], GradingRequest] | None:
        with self._changed:
            while not self._ended:
                if self._waiting and len(self._begun) < self._limit():
                    self._begun[threading.get_ident()] = time.monotonic()
                    return self._waiting.popleft()
                self._changed.wait(_LOOK_S if self._waiting else None)
            return None

    def _done(self) -> None:
        with self._changed:
            self._took.append(time.monotonic() - self._begun.pop(threading.get_ident()))
            if self._looked is None:
                self._look()
            self._changed.notify()

    def _limit(self) -> int:
        """How many may run now."""
        now = time.monotonic()
        if self._looked is None and self._begun and now - min(self._begun.values()) > _STARTED_S:
            self._look()
        if self._looked is not None and now - self._looked > _LOOK_S:
            self._look()
            most = self._most_that_wait if self._most_wait(now) else self._most
            if self._idle_share > _IDLE and self._allowed <= len(self._begun) < most:
                # So many as would have kept all busy, if each of them waits as much as those that run.
                enough = int(self._allowed / max(1.0 - self._idle_share, self._allowed / most))
                self._allowed = min(max(enough, self._allowed + 1), most)
            elif self._idle_share < _BUSY:
                self._allowed = max(self._allowed - 1, self._usual)
        if self._idle_share < _BUSY:
            return self._allowed
        lent = sum(now - begun > _LENT_AFTER_S for begun in self._begun.values())
        return max(self._allowed, min(self._allowed + lent, self._most))

    def _most_wait(self, now: float) -> bool:
        """Whether that can be said of most gradings, those under way included."""
        seconds = [*self._took, *(now - begun for begun in self._begun.values())]
        return statistics.median(seconds) > _LENT_AFTER_S

    def _look(self) -> None:
        self._looked = time.monotonic()
        self._idle_share = self._idle()


class IdleShare:
    """The share of time in which the processors of this process had nothing to do."""

    def __init__(self) -> None:
        self._before = processor_times()

    def __call__(self) -> float:
        """Of the time since it was asked last, 0 to 1; 0 where the kernel does not tell."""
        now = processor_times()
        idle, busy = now.idle - self._before.idle, now.busy - self._before.busy
        self._before = now
        return idle / (idle + busy) if idle + busy > 0.0 else 0.0

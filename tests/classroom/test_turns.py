"""How many gradings run side by side; the gradings themselves are stood in for."""

from __future__ import annotations

import threading
from concurrent.futures import CancelledError, Future, wait
from typing import TYPE_CHECKING, Any

import pytest

from course_kit.classroom import concurrency
from course_kit.classroom.concurrency import GradingQueue, Urgency, put_urgent_early

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

USUAL, AT_FIRST, MOST, MOST_THAT_WAIT = 2, 4, 6, 9
PATIENCE_S = 30.0  # against hanging only


class StandInForGrading:
    """Each request is an event it waits for, or a text it gives back at once; counts how many run side by side."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._running = self.most = 0
        self.begun = threading.Semaphore(0)

    def __call__(self, request: Any) -> Any:
        with self._lock:
            self._running += 1
            self.most = max(self.most, self._running)
        self.begun.release()
        try:
            if isinstance(request, Exception):
                raise request
            return request.wait(PATIENCE_S) if isinstance(request, threading.Event) else request
        finally:
            with self._lock:
                self._running -= 1

    def wait_for(self, number: int) -> None:
        for _ in range(number):
            assert self.begun.acquire(timeout=PATIENCE_S)


@pytest.fixture
def grade() -> StandInForGrading:
    return StandInForGrading()


@pytest.fixture
def made(grade: StandInForGrading) -> Iterator[Callable[[float], GradingQueue]]:
    running: list[GradingQueue] = []

    def make(idle: float) -> GradingQueue:
        running.append(GradingQueue(grade, USUAL, MOST, lambda: idle, most_that_wait=MOST_THAT_WAIT))
        return running[-1]

    yield make
    for one in running:
        one.end()
        one.join()


def submit(turns_: GradingQueue, *requests: Any) -> list[Future[Any]]:
    return [turns_.submit(request) for request in requests]


def test_a_busy_machine_soon_gets_no_more_than_usual(
    grade: StandInForGrading, made: Callable[[float], GradingQueue], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(concurrency, "_LOOK_S", 0.0)
    busy, silent = made(0.0), threading.Event()
    numbers = [str(number) for number in range(40)]
    futures = submit(busy, *[silent] * AT_FIRST, *numbers)
    grade.wait_for(AT_FIRST)
    silent.set()
    assert [future.result(PATIENCE_S) for future in futures[AT_FIRST:]] == numbers
    assert grade.most == AT_FIRST
    grade.most = 0
    assert [future.result(PATIENCE_S) for future in submit(busy, *numbers)] == numbers
    assert 0 < grade.most <= USUAL


def test_where_most_gradings_wait_still_more_are_begun(
    grade: StandInForGrading, made: Callable[[float], GradingQueue], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(concurrency, "_LENT_AFTER_S", 0.0)
    idle, silent = made(1.0), threading.Event()
    futures = submit(idle, *[silent] * (MOST_THAT_WAIT + 2))
    grade.wait_for(MOST_THAT_WAIT)
    assert not futures[-1].running()
    silent.set()
    assert not wait(futures, PATIENCE_S).not_done
    assert grade.most == MOST_THAT_WAIT


def test_what_may_last_begins_early_and_not_all_at_once() -> None:
    def urgency(thing: str) -> Urgency:
        return {"L": Urgency.LOOPS, "W": Urgency.WAITS}.get(thing, Urgency.NONE)

    assert "".join(put_urgent_early("abWcdeLfWgL", urgency)) == "LabLcdWefWg"
    assert "".join(put_urgent_early("WaLLLLL", urgency)) == "LaLLWLL"
    assert "".join(put_urgent_early("aWLL", urgency)) == "LaLW"
    assert put_urgent_early([], urgency) == []


def test_the_end_cancels_what_waits_and_lets_the_rest_finish(
    grade: StandInForGrading, made: Callable[[float], GradingQueue]
) -> None:
    busy, silent = made(0.0), threading.Event()
    futures = submit(busy, *[silent] * AT_FIRST, "late")
    grade.wait_for(AT_FIRST)
    busy.end()
    silent.set()
    busy.join()
    assert [future.result(PATIENCE_S) for future in futures[:AT_FIRST]] == [True] * AT_FIRST
    with pytest.raises(CancelledError):
        futures[-1].result(PATIENCE_S)

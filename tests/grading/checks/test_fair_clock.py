"""What a loaded machine takes away is not counted; what a slow program takes is."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from std_msgs.msg import Float64

from course_kit.grading.checks import fair_clock, hangs
from course_kit.grading.checks.fair_clock import CachedState, FairClock, MachineState, ProcessorUse
from course_kit.grading.checks.hangs import CallBatch


class Time:
    """A clock to be set."""

    def __init__(self) -> None:
        self.now = 100.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Time:
    made = Time()
    monkeypatch.setattr(fair_clock, "time", made)
    monkeypatch.setattr(hangs, "time", made)
    return made


def look(**values: Any) -> MachineState:
    """A state by its figures that are not 0: of the submission (`hidden` among them) and of the grader."""
    submission = ProcessorUse(values.get("computed", 0.0), values.get("waited", 0.0), values.get("hidden", 0.0))
    grader = ProcessorUse(values.get("grader_computed", 0.0), values.get("grader_waited", 0.0))
    return MachineState(submission, grader, values.get("busy"))


def test_waiting_for_a_processor_is_not_counted(clock: Time) -> None:
    states = [look(waited=2.0, grader_waited=5.0)]
    fair = FairClock(CachedState(lambda: states[-1]))
    clock.now += 4.0
    assert fair.fair_s() == 4.0
    states.append(look(waited=3.0, grader_waited=5.0))
    assert fair.fair_s() == 3.0
    states.append(look(waited=3.0, grader_waited=6.5))
    assert fair.fair_s() == 2.5
    assert fair.grader_lost() == 1.5
    assert not fair.has_passed(2.6)
    assert fair.has_passed(2.4)


def test_what_the_grader_has_waited_while_nothing_had_come_is_not_taken_off(clock: Time) -> None:
    states = [look()]
    fair = FairClock(CachedState(lambda: states[-1]), lateness=lambda: 0.2)
    clock.now += 4.0
    states.append(look(grader_waited=3.0))
    assert fair.fair_s() == pytest.approx(3.8)


def test_what_nobody_knows_of_counts_as_the_submissions_own(clock: Time) -> None:
    states = [look(busy=10.0)]
    fair = FairClock(CachedState(lambda: states[-1]))
    clock.now += 4.0
    states.append(look(grader_waited=3.0, busy=18.0))
    assert fair.fair_s() == 1.0
    states.append(look(grader_waited=3.0, hidden=6.0, busy=18.0))
    assert fair.fair_s() == 2.0


def test_threads_are_counted_only_when_the_time_can_be_up(clock: Time) -> None:
    waited, counts = [0.0], []

    def count() -> MachineState:
        counts.append(clock.now)
        return look(waited=waited[-1])

    fair = FairClock(CachedState(count))
    counts.clear()
    for _ in range(10):
        clock.now += 1.0
        waited.append(waited[-1] + 0.5)
        if fair.has_passed(4.0):
            break
    assert fair.wall_s() == 8.0
    assert counts == [104.0, 106.0, 107.0, 108.0]


@pytest.mark.parametrize(
    ("after", "share", "fair"),
    [
        # One thread, half of the time in the queue: the other programs have had that half.
        ({"waited": 5.0, "computed": 5.0, "busy": 20.0}, 1.0, 5.0),
        # Twelve on an idle machine of two processors: whoever waits, waits for one of them.
        ({"waited": 8.0, "computed": 20.0, "busy": 20.0}, 1.0, 10.0),
        # They stand in each other's way half of the time, on the one processor of two that they have chosen.
        ({"waited": 4.0, "computed": 5.0, "busy": 5.0}, 1.0, 10.0),
        # They keep the grader from running.
        ({"waited": 2.0, "computed": 19.0, "grader_waited": 8.0, "grader_computed": 1.0, "busy": 20.0}, 1.0, 10.0),
        # The grader is kept from it by others.
        ({"waited": 0.0, "computed": 1.0, "grader_waited": 8.0, "grader_computed": 1.0, "busy": 20.0}, 1.0, 2.0),
        # Half a processor, and nobody else wants it: the machine is slow, and that is all.
        ({"waited": 5.0, "computed": 5.0, "busy": 64.0}, 0.5, 10.0),
        # Nobody knows what others do.
        ({"waited": 5.0, "computed": 5.0}, 1.0, 5.0),
    ],
)
def test_only_what_others_have_taken_is_not_counted(
    after: dict[str, float], share: float, fair: float, clock: Time
) -> None:
    states = [look(busy=0.0 if "busy" in after else None)]
    counted = FairClock(CachedState(lambda: states[-1]), share=share)
    clock.now += 10.0
    states.append(look(**after))
    assert counted.fair_s() == pytest.approx(fair)


def test_only_the_client_that_suffered_most_was_kept_waiting(clock: Time) -> None:
    """A server that answers one after the other gets no time for each answer that was noticed late."""
    sent = [SimpleNamespace(is_answered=lambda *_: False) for _ in range(4)]
    clients = [SimpleNamespace(send=lambda _, one=one: one) for one in sent]
    batch = CallBatch(clients, [None] * 4)  # type: ignore[arg-type, list-item]
    assert not batch.exchange()
    clock.now += 3.0  # the grader waits long for a processor, and nothing has come
    batch.exchange()
    assert batch.lateness() == 0.0
    for one in sent:
        clock.now += 0.5
        one.is_answered, one.response = lambda *_: True, Float64
        batch.exchange()
    assert batch.answered == 4
    assert batch.lateness() == 0.5

"""Where gradings wait for a ROS domain of the machine: the time in the queue is not the submission's."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from course_kit import environment
from course_kit.grading.checks.context import CheckContext
from course_kit.grading.model import limits
from course_kit.grading.model.job import Job
from course_kit.grading.sandbox import supervisor
from course_kit.grading.sandbox.channel import Channel
from course_kit.grading.sandbox.file_view import FileView
from course_kit.grading.sandbox.launcher import Launcher

if TYPE_CHECKING:
    from collections.abc import Iterator

JOB = Job("course_kit.graders.temperature_service", "run", "answer.py", seed=1, limits=limits.Limits(wall_s=1.0))


class StandInClock:
    """Time that passes only in the queue."""

    def __init__(self) -> None:
        self.now = 1000.0

    def monotonic(self) -> float:
        return self.now


class StandInWarden(supervisor.Supervisor):
    """Queues for a domain, and then starts nothing in it."""

    def _launch(self, *_: Any, **_options: Any) -> dict[str, Any]:
        domain, queued_s = self._domain()
        return {"domain": domain, "queued_s": queued_s}


class StandInQueue:
    """Gives a domain after some time, or none when that is too long."""

    def __init__(self, clock: StandInClock, waits_s: float) -> None:
        self.clock, self.waits_s = clock, waits_s
        self.patience: list[float] = []

    @contextmanager
    def __call__(self, patience_s: float) -> Iterator[int]:
        self.patience.append(patience_s)
        self.clock.now += min(self.waits_s, patience_s)
        if self.waits_s > patience_s:
            raise environment.NoDomainError
        yield 7


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> StandInClock:
    ours = StandInClock()
    monkeypatch.setattr(supervisor, "time", ours)
    return ours


@pytest.fixture
def line() -> Iterator[tuple[Channel, Channel]]:
    """The supervisor's end and the grader process's."""
    ours, grader_process = Channel.pair()
    yield ours, grader_process
    ours.close()
    grader_process.close()


def problem_of(line: tuple[Channel, Channel], launches: int) -> str:
    """What the supervisor says of a grading whose grader process starts the submission so often."""
    ours, grader_process = line
    for _ in range(launches):
        grader_process.send({"do": "launch", "arguments": [], "files": {}, "variables": {}})
    grader_process.send({"do": "done", "problem": ""})
    launcher, end = Launcher.pair()  # nobody is asked to start anything
    try:
        return StandInWarden(JOB, launcher, FileView(), lambda *_: None)._serve(ours)
    finally:
        launcher.close()
        end.close()


def test_a_long_queue_leaves_the_whole_time_for_the_grading(
    clock: StandInClock, line: tuple[Channel, Channel], monkeypatch: pytest.MonkeyPatch
) -> None:
    waits_s = 0.9 * limits.QUEUE_S
    assert waits_s > JOB.limits.wall_s + supervisor._GRADER_GRACE_S
    monkeypatch.setattr(environment, "exclusive_domain", StandInQueue(clock, waits_s))
    assert problem_of(line, 1) == ""
    assert line[1].receive(10.0) == {"domain": 7, "queued_s": waits_s}


def test_a_check_has_its_whole_time_after_a_queue(line: tuple[Channel, Channel], domain: int) -> None:
    ours, grader_process = line
    context = CheckContext(grader_process, JOB)
    context.begin(0.0)
    assert context.time_is_up()
    ours.send({"domain": domain, "queued_s": 100.0})
    context.launch()
    context.close()
    assert not context.time_is_up()
    context.begin(0.0)
    assert context.time_is_up()

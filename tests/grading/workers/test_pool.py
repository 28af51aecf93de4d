"""A pool: a worker that is hurt from outside costs nobody a grade; and the loop that gives graders enough to do."""

from __future__ import annotations

from concurrent.futures import Future
from typing import Any

from course_kit.grading.model.report import Report
from course_kit.grading.pool import grade_all


class StandInGraders:
    """Two at a time, whose requests are texts that come back when they are asked to finish."""

    slots = 2

    def __init__(self) -> None:
        self.begun: dict[str, Future[Any]] = {}

    def submit(self, request: Any) -> Future[Any]:
        self.begun[request] = Future()
        return self.begun[request]

    def finish(self, *requests: str) -> None:
        for request in requests:
            self.begun[request].set_result(Report("", "", request, "graded", True, 1.0, 1.0, 0.0))

    def require_reachable(self) -> None:
        """They always are."""

    def close(self) -> None:
        """There is nothing to end."""


def test_graders_get_enough_to_do_and_stop_when_somebody_asks_for_it() -> None:
    graders, stops, heard = StandInGraders(), [0], []

    def listen(under_way: int) -> None:
        heard.append(under_way)
        if len(heard) == 1:
            graders.finish("a")
        elif len(heard) == 2:  # of the next four two are at work
            graders.begun["b"].set_running_or_notify_cancel()
            graders.begun["c"].set_running_or_notify_cancel()
            graders.finish("b")
            stops[0] = 1
        else:
            graders.finish("c")

    requests: Any = ((name, name) for name in "abcdefgh")
    found = [(thing, report.submission) for thing, report in grade_all(graders, requests, lambda: stops[0], listen)]
    assert found == [("a", "a"), ("b", "b"), ("c", "c")]
    assert heard == [4, 4, 1]
    assert "".join(graders.begun) == "abcde"
    assert graders.begun["d"].cancelled()


def test_whoever_asks_twice_to_stop_waits_for_nothing() -> None:
    graders, stops = StandInGraders(), [0]
    requests: Any = [("a", "a")]
    assert list(grade_all(graders, requests, lambda: stops[0], lambda _: stops.__setitem__(0, 2))) == []


def test_a_report_that_is_there_already_needs_no_grader() -> None:
    report = Report("", "", "", "unreadable", False, 0.0, 1.0, 0.0)
    assert list(grade_all(StandInGraders(), [("a", report)])) == [("a", report)]

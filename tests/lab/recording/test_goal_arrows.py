from __future__ import annotations

from typing import Any

import pytest

from course_kit.lab.recording.diagram import RUN, UNSEEN, Diagram, arrows_of
from course_kit.lab.recording.events import Event
from course_kit.ros.sequence import Arrow

Step = tuple[str, Any]
YES, NO = {"accepted": True}, {"accepted": False}
END = {"status": "SUCCEEDED", "result": {"sequence": [0, 1]}}


def story(*steps: Step, client: str = "lab", server: str = "/fib", goal: int = 7, start: int = 0) -> list[Event]:
    """Events one after the other; those of a kind that only a client reports are its."""
    of_client = {"sent", "answer_received", "feedback_received", "cancel_sent", "result_received"}
    return [
        Event(
            kind,  # type: ignore[arg-type] # spelt out in the tests
            client if kind.removeprefix("goal_").removeprefix("cancel_answer") in of_client else server,
            "/fibonacci",
            "x/action/Fibonacci",
            value,
            goal,
            start + at,
        )
        for at, (kind, value) in enumerate(steps)
    ]


def lines(events: list[Event]) -> list[str]:
    return str(Diagram(arrows_of(events))).splitlines()


WHOLE: list[Step] = [
    ("goal_sent", {"order": 2}),
    ("goal_received", {"order": 2}),
    ("goal_answered", YES),
    ("goal_answer_received", YES),
    ("feedback_sent", {"n": 1}),
    ("feedback_received", {"n": 1}),
    ("result_sent", END),
    ("result_received", END),
]


def test_a_goal_is_drawn_once_although_both_sides_report_it() -> None:
    assert arrows_of(story(*WHOLE)) == [
        Arrow("lab", "/fib", "goal", "order=2", "/fibonacci"),
        Arrow("/fib", "lab", "goal response", "accepted", "/fibonacci"),
        Arrow("/fib", "lab", "feedback", "n=1", "/fibonacci"),
        Arrow("/fib", "lab", "result", "SUCCEEDED, sequence=[0, 1]", "/fibonacci"),
    ]


@pytest.mark.parametrize(("side", "ends"), [("client", ("lab", UNSEEN)), ("server", (UNSEEN, "/fib"))])
def test_what_one_side_reports_is_enough(side: str, ends: tuple[str, str]) -> None:
    events = [one for one in story(*WHOLE) if (one.node == "lab") == (side == "client")]
    arrows = arrows_of(events)
    assert [arrow.kind for arrow in arrows] == ["goal", "goal response", "feedback", "result"]
    assert (arrows[0].sender, arrows[0].receiver) == ends
    assert {(arrow.sender, arrow.receiver) for arrow in arrows[1:]} == {ends[::-1]}


def test_a_rejection_and_a_silence_are_told_apart() -> None:
    asked: list[Step] = [("goal_sent", {"order": 2}), ("goal_received", {"order": 2})]
    assert lines(story(*asked, ("goal_answered", NO)))[1] == "2. fib -> lab  /fibonacci goal response: rejected"
    assert lines(story(*asked))[1] == "2. fib --x lab  /fibonacci no answer so far"


def test_a_long_run_of_feedback_is_folded() -> None:
    asked = WHOLE[:4]
    feedback: list[Step] = [("feedback_sent", {"n": number}) for number in range(RUN + 1)]
    assert len(lines(story(*asked, *feedback[:-1]))) == 2 + RUN
    assert lines(story(*asked, *feedback, ("result_sent", END)))[2:] == [
        "3. fib -> lab  /fibonacci feedback: n=0",
        f"4. fib -> lab  /fibonacci feedback: ... {RUN - 1} more",
        f"5. fib -> lab  /fibonacci feedback: n={RUN}",
        "6. fib -> lab  /fibonacci result: SUCCEEDED, sequence=[0, 1]",
    ]


def test_a_cancel_request_divides_the_feedback_and_is_answered() -> None:
    run: list[Step] = [("feedback_sent", {"n": number}) for number in range(RUN + 2)]
    asked: list[Step] = [("cancel_sent", {}), ("cancel_received", {})]
    drawn = lines(story(*WHOLE[:4], *run, *asked, ("cancel_answered", NO), *run[:2], *asked, ("cancel_answered", YES)))
    assert drawn[2:] == [
        "3. fib -> lab  /fibonacci feedback: n=0".replace("3.", " 3."),
        " 4. fib -> lab  /fibonacci feedback: ... 4 more",
        " 5. fib -> lab  /fibonacci feedback: n=5",
        " 6. lab -> fib  /fibonacci cancel request",
        " 7. fib -> lab  /fibonacci cancel response: refused",
        " 8. fib -> lab  /fibonacci feedback: n=0",
        " 9. fib -> lab  /fibonacci feedback: n=1",
        "10. lab -> fib  /fibonacci cancel request",
        "11. fib -> lab  /fibonacci cancel response: accepted",
    ]


def test_goals_at_the_same_time_are_numbered_and_others_are_not() -> None:
    first, second = story(*WHOLE, goal=1), story(*WHOLE, goal=2, start=3)
    texts = [arrow.channel for arrow in arrows_of(first + second)]
    assert sorted(set(texts)) == ["/fibonacci (goal 1)", "/fibonacci (goal 2)"]
    later = story(*WHOLE, goal=2, start=100)
    assert {arrow.channel for arrow in arrows_of(first + later)} == {"/fibonacci"}

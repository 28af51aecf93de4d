from __future__ import annotations

from typing import Any

from course_kit.lab.recording.diagram import DRAWN, NOBODY, UNSEEN, arrows_of, draw_diagram
from course_kit.lab.recording.events import KEPT, Event, Recording
from course_kit.ros.sequence import Arrow


class Story:
    """Events one after the other."""

    def __init__(self) -> None:
        self.events: list[Event] = []

    def add(self, kind: Any, node: str, value: Any, sequence: int = 1, channel: str = "/add") -> Story:
        self.events.append(Event(kind, node, channel, "x/srv/Add", value, sequence, len(self.events)))
        return self


def call(story: Story, value: Any, answer: Any, sequence: int = 1) -> None:
    story.add("request_sent", "lab", value, sequence).add("request_received", "/adder", value, sequence)
    story.add("response_sent", "/adder", answer, sequence).add("response_received", "lab", answer, sequence)


def test_a_call_is_two_arrows() -> None:
    story = Story()
    call(story, {"a": 1, "b": 2}, {"sum": 3})
    assert arrows_of(story.events) == [
        Arrow("lab", "/adder", "request", "a=1, b=2", "/add"),
        Arrow("/adder", "lab", "response", "sum=3", "/add"),
    ]


def test_clients_that_count_alike_are_told_apart_by_their_values() -> None:
    story = Story()
    story.add("request_sent", "/left", {"a": 1}).add("request_sent", "/right", {"a": 2})
    story.add("request_received", "/adder", {"a": 2}).add("response_sent", "/adder", {"sum": 2})
    story.add("request_received", "/adder", {"a": 1}).add("response_sent", "/adder", {"sum": 1})
    ends = [(arrow.sender, arrow.receiver, arrow.text) for arrow in arrows_of(story.events)]
    assert ends == [
        ("/left", "/adder", "a=1"),
        ("/right", "/adder", "a=2"),
        ("/adder", "/right", "sum=2"),
        ("/adder", "/left", "sum=1"),
    ]


def test_no_answer_and_a_failure_show() -> None:
    waiting = Story().add("request_sent", "lab", {}).add("request_received", "/adder", {})
    assert arrows_of(waiting.events)[1] == Arrow("/adder", "lab", "failure", "no answer so far", "/add")
    waiting.add("callback_failed", "/adder", "ValueError: no")
    assert arrows_of(waiting.events)[1] == Arrow("/adder", "lab", "failure", "no answer: ValueError: no", "/add")


def test_what_nobody_reported_is_another_program() -> None:
    story = Story().add("request_sent", "lab", {}).add("response_received", "lab", {"sum": 1})
    assert [(arrow.sender, arrow.receiver) for arrow in arrows_of(story.events)] == [("lab", UNSEEN), (UNSEEN, "lab")]
    story = Story().add("request_received", "/adder", {}).add("response_sent", "/adder", {"sum": 1})
    assert [(arrow.sender, arrow.receiver) for arrow in arrows_of(story.events)] == [
        (UNSEEN, "/adder"),
        ("/adder", UNSEEN),
    ]


def test_a_message_reaches_each_of_its_listeners() -> None:
    story = Story().add("published", "/talker", {"data": "x"}, 0, "/chatter")
    assert arrows_of(story.events) == [Arrow("/talker", NOBODY, "message", "data='x'", "/chatter")]
    for listener in ("/b", "/a"):
        story.add("received", listener, {"data": "x"}, 0, "/chatter")
    assert [arrow.receiver for arrow in arrows_of(story.events)] == ["/a", "/b"]
    story.add("received", "/a", {"data": "else"}, 0, "/chatter")
    assert arrows_of(story.events)[-1].sender == UNSEEN


def test_a_recording_is_bounded_sorted_and_can_begin_anew() -> None:
    recording = Recording()
    story = Story()
    for number in range(KEPT):
        call(story, {"a": number}, {"sum": number}, number)
    for event in reversed(story.events):
        recording.observe(event)
    assert len(recording.events) == KEPT
    assert [event.at for event in recording.events] == sorted(event.at for event in recording.events)
    assert len(draw_diagram(recording.events).arrows) == DRAWN
    assert len(draw_diagram(recording.events, last=3).arrows) == 3
    assert draw_diagram(recording.events, last=0).arrows == []
    recording.restart()
    assert recording.events == []

"""The sequence diagram: from events to arrows, who said what to whom; an SVG in a page, numbered lines everywhere else.

Each side reports what it saw by itself. A request is known again by its service, its number and its values; the number
alone is not enough, because every client counts from 1. Of a goal, what the server has seen is drawn; of a long run of
its feedback the first and the last, and how many were between them.

The page needs nothing but itself. The lines say the same in words, for a screen reader, a terminal and a stored
notebook; neither holds times or identifiers.
"""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.ros.names import short_name
from course_kit.ros.sequence import STYLE_SHEET, Arrow, sequence_svg
from course_kit.ros.showing import describe_message
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.lab.recording.events import Event

_AS_CLIENT_SAW_IT = {
    "goal_answered": "goal_answer_received",
    "feedback_sent": "feedback_received",
    "cancel_answered": "cancel_answer_received",
    "result_sent": "result_received",
}
_FROM_SERVER = frozenset({"goal_received", "cancel_received", *_AS_CLIENT_SAW_IT})
_FROM_CLIENT = frozenset({"goal_sent", "cancel_sent", *_AS_CLIENT_SAW_IT.values()})
GOAL_KINDS = _FROM_SERVER | _FROM_CLIENT
UNSEEN = "another program"  # takes part, and its name is unknown
RUN = 4  # feedback messages in a row that are all drawn

Timed = tuple[tuple[int, int], Arrow]  # when it crossed, in nanoseconds, and its place among those of that moment
NOBODY = "nobody"


@dataclass
class _Leg:
    """A request as one server has seen it."""

    server: str
    ending: Event | None = None  # the response sent, or the failure


@dataclass
class _Exchange:
    """A request and what came of it."""

    request: Event
    client: str
    legs: list[_Leg] = field(default_factory=list)
    answer: Event | None = None  # as the client has seen it

    def is_of(self, event: Event) -> bool:
        return (self.request.channel, self.request.sequence) == (event.channel, event.sequence)


@dataclass
class _Message:
    """A message and who has received it."""

    event: Event
    sender: str
    receivers: list[str] = field(default_factory=list)


def arrows_of(events: list[Event]) -> list[Arrow]:
    """The arrows of a sequence diagram, in the order of the events given."""
    exchanges: list[_Exchange] = []
    messages: list[_Message] = []
    for event in events:
        if event.kind == "request_sent":
            exchanges.append(_Exchange(event, event.node))
        elif event.kind == "request_received":
            _note_received(event, exchanges)
        elif event.kind in {"response_sent", "callback_failed"}:
            _note_ending(event, exchanges)
        elif event.kind == "response_received":
            _note_answer(event, exchanges)
        elif event.kind == "published":
            messages.append(_Message(event, event.node))
        elif event.kind == "received":
            _note_message(event, messages)
    timed = [pair for exchange in exchanges for pair in _draw_exchange(exchange)]
    timed += goal_arrows(events)
    timed += [pair for message in messages for pair in _draw_message(message)]
    return [arrow for _, arrow in sorted(timed, key=lambda pair: pair[0])]


def _note_received(event: Event, exchanges: list[_Exchange]) -> None:
    same = [exchange for exchange in exchanges if exchange.is_of(event) and exchange.request.value == event.value]
    fresh = [exchange for exchange in same if not exchange.legs]
    # Two servers of one name both get the request: then it is the latest one, seen a second time.
    again = [exchange for exchange in reversed(same) if all(leg.server != event.node for leg in exchange.legs)]
    found = next(iter(fresh + again), None)
    if found is None:
        found = _Exchange(event, UNSEEN)
        exchanges.append(found)
    found.legs.append(_Leg(event.node))


def _note_ending(event: Event, exchanges: list[_Exchange]) -> None:
    for exchange in exchanges:
        for leg in exchange.legs:
            if exchange.is_of(event) and leg.server == event.node and leg.ending is None:
                leg.ending = event
                return


def _note_answer(event: Event, exchanges: list[_Exchange]) -> None:
    for exchange in exchanges:
        if exchange.is_of(event) and exchange.client == event.node and exchange.answer is None:
            exchange.answer = event
            return


def _note_message(event: Event, messages: list[_Message]) -> None:
    for message in messages:
        sent = message.event
        if sent.channel == event.channel and sent.value == event.value and event.node not in message.receivers:
            message.receivers.append(event.node)
            return
    messages.append(_Message(event, UNSEEN, [event.node]))


def _draw_exchange(exchange: _Exchange) -> list[Timed]:
    request, client = exchange.request, exchange.client
    drawn = []
    for leg in exchange.legs or [_Leg(UNSEEN)]:
        asked = Arrow(client, leg.server, "request", describe_message(request.value), request.channel)
        drawn.append(((request.at, 0), asked))
        ending = leg.ending or (exchange.answer if not exchange.legs else None)
        if ending is None:
            drawn.append(((request.at, 1), Arrow(leg.server, client, "failure", "no answer so far", request.channel)))
        elif ending.kind == "callback_failed":
            text = f"no answer: {ending.value}"
            drawn.append(((ending.at, 2), Arrow(leg.server, client, "failure", text, request.channel)))
        else:
            answer = Arrow(leg.server, client, "response", describe_message(ending.value), request.channel)
            drawn.append(((ending.at, 2), answer))
    return drawn


def _draw_message(message: _Message) -> list[Timed]:
    event = message.event
    return [
        ((event.at, number), Arrow(message.sender, receiver, "message", describe_message(event.value), event.channel))
        for number, receiver in enumerate(sorted(message.receivers) or [NOBODY])
    ]


class _Goal:
    """All that was reported about one goal, in the order of time."""

    def __init__(self, events: list[Event]) -> None:
        self.events = events
        self.channel = events[0].channel
        self.client = next((event.node for event in events if event.kind in _FROM_CLIENT), UNSEEN)
        servers = dict.fromkeys(event.node for event in events if event.kind in _FROM_SERVER)
        self.servers = list(servers) or [UNSEEN]

    def events_of(self, kind: str, server: str) -> list[Event]:
        """Events of a kind as a server has reported them; as the client has, of a server that reports nothing."""
        if server == UNSEEN:
            return [event for event in self.events if event.kind == _AS_CLIENT_SAW_IT[kind]]
        return [event for event in self.events if event.kind == kind and event.node == server]


def goal_arrows(events: list[Event]) -> list[Timed]:
    """The arrows of all goals, each with its place in time."""
    found: dict[tuple[str, int], list[Event]] = {}
    for event in events:
        if event.kind in GOAL_KINDS:
            found.setdefault((event.channel, event.sequence), []).append(event)
    goals = [_Goal(events) for events in found.values()]
    for channel in {goal.channel for goal in goals}:
        _number([goal for goal in goals if goal.channel == channel])
    return [timed for goal in goals for server in goal.servers for timed in _draw(goal, server)]


def _number(goals: list[_Goal]) -> None:
    """Tell goals of one action apart that were on their way at the same time."""
    if any(goal.events[-1].at >= later.events[0].at for goal, later in pairwise(goals)):
        for number, goal in enumerate(goals, 1):
            goal.channel += f" (goal {number})"


def _draw(goal: _Goal, server: str) -> list[Timed]:
    steps = _ask(goal, server) + _answers(goal, server) + _feedback(goal, server) + _draw_cancelling(goal, server)
    for event in goal.events_of("result_sent", server)[:1]:
        text = f"{event.value['status']}, {describe_message(event.value['result'])}"
        steps.append(((event.at, 3), Arrow(server, goal.client, "result", text, goal.channel)))
    return steps


def _ask(goal: _Goal, server: str) -> list[Timed]:
    sent = [event for event in goal.events if event.kind == "goal_sent"]
    received = [event for event in goal.events if event.kind == "goal_received" and event.node == server]
    return [
        ((event.at, 0), Arrow(goal.client, server, "goal", describe_message(event.value), goal.channel))
        for event in (sent or received)[:1]
    ]


def _answers(goal: _Goal, server: str) -> list[Timed]:
    seen = goal.events_of("goal_answered", server)
    if seen:
        # A server's report of a rejection is made when it has been sent; the client may have reported it before.
        at = min(event.at for event in [*seen, *goal.events_of("goal_answered", UNSEEN)])
        text = "accepted" if seen[0].value["accepted"] else "rejected"
        return [((at, 1), Arrow(server, goal.client, "goal response", text, goal.channel))]
    asked = [event for event in goal.events if event.kind in {"goal_sent", "goal_received"}]
    return [
        ((event.at, 1), Arrow(server, goal.client, "failure", "no answer so far", goal.channel)) for event in asked[:1]
    ]


def _feedback(goal: _Goal, server: str) -> list[Timed]:
    breaks = [event.at for event in goal.events if event.kind.startswith("cancel")]
    runs: list[list[Event]] = [[]]
    for event in goal.events_of("feedback_sent", server):
        if runs[-1] and any(runs[-1][-1].at < at < event.at for at in breaks):
            runs.append([])
        runs[-1].append(event)
    return [timed for run in runs for timed in _fold(goal, server, run)]


def _fold(goal: _Goal, server: str, run: list[Event]) -> list[Timed]:
    texts = [(event.at, describe_message(event.value)) for event in run]
    if len(run) > RUN:
        texts = [texts[0], (run[1].at, f"... {len(run) - 2} more"), texts[-1]]
    return [((at, 2), Arrow(server, goal.client, "feedback", text, goal.channel)) for at, text in texts]


def _draw_cancelling(goal: _Goal, server: str) -> list[Timed]:
    sent = [event for event in goal.events if event.kind == "cancel_sent"]
    received = [event for event in goal.events if event.kind == "cancel_received" and event.node == server]
    asking = [event.node for event in sent] or [UNSEEN] * len(received)
    drawn = [
        ((event.at, 0), Arrow(client, server, "cancel request", "", goal.channel))
        for client, event in zip(asking, sent or received, strict=True)
    ]
    for client, event in zip(asking, goal.events_of("cancel_answered", server), strict=False):
        text = "accepted" if event.value["accepted"] else "refused"
        drawn.append(((event.at, 1), Arrow(server, client, "cancel response", text, goal.channel)))
    return drawn


_TEMPLATE = Path(__file__).with_name("templates") / "exchange.html"
WIDTH = 80
_EMPTY = "Nothing has been recorded yet: call a service, then draw again."
_UNNAMED = frozenset({"message", "failure"})  # a topic has nothing else; a failure says itself what it is


class Diagram:
    """A sequence diagram that a notebook displays."""

    def __init__(self, arrows: Sequence[Arrow], left_out: int = 0) -> None:
        self.arrows = list(arrows)
        self.left_out = left_out

    @property
    def participants(self) -> list[str]:
        return list(dict.fromkeys(name for arrow in self.arrows for name in (arrow.sender, arrow.receiver)))

    def html(self) -> str:
        """The diagram as HTML: the drawing, a slider to go through it step by step, and the steps in words."""
        names = {name: short_name(name) for name in self.participants}
        steps = [(arrow, _line(_label(arrow))) for arrow in self.arrows]
        missing = self._describe_left_out() if self.left_out else ""
        if missing:
            first = next(iter(names))
            steps.insert(0, (Arrow(first, first, "note", missing), missing))
        words = [f"{_ends(arrow)}  {_line(_label(arrow))}" for arrow in self.arrows]
        return str(
            render_template(
                _TEMPLATE,
                drawing=sequence_svg(steps, names, f"Sequence diagram: {self._summary()}"),
                sequence_css=render_template(STYLE_SHEET),
                steps=words,
                missing=missing,
                summary=self._summary(),
            )
        )

    def __repr__(self) -> str:
        """The diagram in numbered lines of at most 80 columns."""
        if not self.arrows:
            return _EMPTY
        lines = [self._describe_left_out()] if self.left_out else []
        digits = len(str(len(self.arrows)))
        for number, arrow in enumerate(self.arrows, 1):
            text = f"{number:>{digits}}. {_ends(arrow)}  {_line(_label(arrow))}"
            lines += textwrap.wrap(text, WIDTH, subsequent_indent=" " * (digits + 4), break_on_hyphens=False)
        return "\n".join(lines)

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        if not self.arrows:
            return {"text/plain": _EMPTY}
        return {"text/html": self.html(), "text/plain": str(self)}

    def _summary(self) -> str:
        names = ", ".join(short_name(name) for name in self.participants)
        count = len(self.arrows)
        return f"{count} {'message' if count == 1 else 'messages'} between {names}."

    def _describe_left_out(self) -> str:
        return f"{self.left_out} earlier {'line is' if self.left_out == 1 else 'lines are'} left out."


def _label(arrow: Arrow) -> str:
    if arrow.kind in _UNNAMED:
        return f"{arrow.channel} {arrow.text}"
    return f"{arrow.channel} {arrow.kind}" + (f": {arrow.text}" if arrow.text else "")


def _ends(arrow: Arrow) -> str:
    sign = "--x" if arrow.kind == "failure" else "->"
    return f"{short_name(arrow.sender)} {sign} {short_name(arrow.receiver)}"


def _line(text: str) -> str:
    return " ".join(text.split())


DRAWN = 60  # arrows, unless the caller wants another number


def draw_diagram(events: list[Event], last: int | None = None) -> Diagram:
    """Draw the latest arrows, `last` of them at most."""
    arrows = arrows_of(events)
    count = DRAWN if last is None else max(0, last)
    return Diagram(arrows[len(arrows) - min(count, len(arrows)) :], left_out=max(0, len(arrows) - count))

"""From events to arrows: who said what to whom.

Each side reports what it saw by itself. A request is known again by its service, its number and its values; the
number alone is not enough, because every client counts from 1. Goals are drawn by `goal_arrows`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_kit.lab.recording.goal_arrows import UNSEEN, goal_arrows
from course_kit.ros.sequence import Arrow
from course_kit.ros.showing import describe_message

if TYPE_CHECKING:
    from course_kit.lab.recording.events import Event
    from course_kit.lab.recording.goal_arrows import Timed

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
    same = [one for one in exchanges if one.is_of(event) and one.request.value == event.value]
    fresh = [one for one in same if not one.legs]
    # Two servers of one name both get the request: then it is the latest one, seen a second time.
    again = [one for one in reversed(same) if all(leg.server != event.node for leg in one.legs)]
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

"""From events to time lines: which thread was inside which callback, and what waited to be taken in meanwhile."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from course_kit.ros.names import short_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from course_kit.lab.recording.events import Event

SPAN_KINDS = frozenset({"callback_begun", "callback_ended"})
_LAB_THREAD = "ros-lab"
_WORDS = {"service": "answers {}", "topic": "hears {}", "timer": "timer {}", "goal": "executes a goal of {}"}
# What is sent and has to be taken in by a thread of the other side, with a word for it.
_TAKEN_IN = {
    "request_received": ("request_sent", "a request to {}"),
    "response_received": ("response_sent", "the response of {}"),
    "goal_received": ("goal_sent", "a goal for {}"),
    "cancel_received": ("cancel_sent", "the cancel request to {}"),
}
_SENT = {sent: taken for taken, (sent, _) in _TAKEN_IN.items()}


@dataclass
class Busy:
    """A thread inside a callback, without a pause."""

    lane: str
    node: str
    label: str
    begin: int
    end: int | None = None
    failed: bool = False


class MessageWait(NamedTuple):
    """Something sent that nobody had taken in yet."""

    label: str
    begin: int
    end: int | None


def busy_times(events: Iterable[Event], own_process: int) -> list[Busy]:
    """What each thread was busy with, in the order of time."""
    open_spans: dict[tuple[int, int], Busy] = {}
    found: list[Busy] = []
    lanes: dict[tuple[int, int], str] = {}
    for event in events:
        if event.kind not in SPAN_KINDS:
            continue
        key = (event.value["process"], event.sequence)
        if event.kind == "callback_ended":
            span = open_spans.pop(key, None)
            if span is not None:
                span.end, span.failed = event.at, bool(event.value["failed"])
            continue
        lane = _lane(event, own_process, lanes)
        label = _WORDS[event.value["what"]].format(event.channel)
        open_spans[key] = Busy(lane, short_name(event.node), label, event.at)
        found.append(open_spans[key])
    return found


def _lane(event: Event, own_process: int, lanes: dict[tuple[int, int], str]) -> str:
    """What to call the thread: threads of goals and of pools are numbered as they come."""
    process, name = event.value["process"], event.value["thread"]
    key = (process, event.value["ident"])
    if key not in lanes:
        owner = "lab" if process == own_process else f"program of {short_name(event.node)}"
        if name == _LAB_THREAD:
            kind = "main thread"
        elif process == own_process:
            kind = "goal thread"
        else:
            kind = "main thread" if name == "MainThread" else "pool thread"
        same = sum(lane.startswith(f"{owner}, {kind}") for lane in lanes.values())
        lanes[key] = f"{owner}, {kind}" + (f" {same + 1}" if same else "")
    return lanes[key]


def waiting_times(events: Iterable[Event], busy: Sequence[Busy], least: int) -> list[MessageWait]:
    """What was never taken in, or waited for a thread that was busy."""
    sent: dict[tuple[str, str, int], Event] = {}
    found = []
    for event in events:
        if event.kind in _SENT:
            sent[_SENT[event.kind], event.channel, event.sequence] = event
        elif event.kind in _TAKEN_IN:
            before = sent.pop((event.kind, event.channel, event.sequence), None)
            if before is not None and _blocked(event.node, before.at, event.at, busy) >= least:
                found.append(MessageWait(_label(event.kind, event.channel), before.at, event.at))
    found += [MessageWait(_label(kind, channel), event.at, None) for (kind, channel, _), event in sent.items()]
    return sorted(found, key=lambda one: one.begin)


def _blocked(node: str, begin: int, end: int, busy: Sequence[Busy]) -> int:
    """For how long of a time a node was inside a callback."""
    own = [one for one in busy if one.node == short_name(node)]
    return sum(max(0, min(end, one.end or end) - max(begin, one.begin)) for one in own)


def _label(kind: str, channel: str) -> str:
    return _TAKEN_IN[kind][1].format(channel)

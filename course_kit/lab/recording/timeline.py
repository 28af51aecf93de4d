"""Time lines of threads: who was inside which callback, from when to when, and what waited to be taken in meanwhile.

The drawing has the times that were measured; the words hold none, so that they are the same in every run.
"""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from course_kit.ros.names import short_name
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from course_kit.lab.recording.events import Event

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
class CallbackSpan:
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


def busy_times(events: Iterable[Event], own_process: int) -> list[CallbackSpan]:
    """What each thread was busy with, in the order of time."""
    open_spans: dict[tuple[int, int], CallbackSpan] = {}
    found: list[CallbackSpan] = []
    lanes: dict[tuple[int, int], str] = {}
    for event in events:
        key = (event.value["process"], event.sequence)
        if event.kind == "callback_ended":
            span = open_spans.pop(key, None)
            if span is not None:
                span.end, span.failed = event.at, bool(event.value["failed"])
            continue
        lane = _lane(event, own_process, lanes)
        label = _WORDS[event.value["what"]].format(event.channel)
        open_spans[key] = CallbackSpan(lane, short_name(event.node), label, event.at)
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


def waiting_times(events: Iterable[Event], busy: Sequence[CallbackSpan], least: int) -> list[MessageWait]:
    """What was never taken in, or waited for a thread that was busy."""
    sent: dict[tuple[str, str, int], Event] = {}
    found = []
    for event in events:
        if event.kind in _SENT:
            sent[_SENT[event.kind], event.channel, event.sequence] = event
        elif event.kind in _TAKEN_IN:
            before = sent.pop((event.kind, event.channel, event.sequence), None)
            if before is not None and _blocked_time(event.node, before.at, event.at, busy) >= least:
                found.append(MessageWait(_label(event.kind, event.channel), before.at, event.at))
    found += [MessageWait(_label(kind, channel), event.at, None) for (kind, channel, _), event in sent.items()]
    return sorted(found, key=lambda span: span.begin)


def _blocked_time(node: str, begin: int, end: int, busy: Sequence[CallbackSpan]) -> int:
    """For how long of a time a node was inside a callback."""
    own = [span for span in busy if span.node == short_name(node)]
    return sum(max(0, min(end, span.end or end) - max(begin, span.begin)) for span in own)


def _label(kind: str, channel: str) -> str:
    return _TAKEN_IN[kind][1].format(channel)


_TEMPLATE = Path(__file__).with_name("templates") / "timeline.html"
_EMPTY = "No callback has run yet since the recording began."
_WAIT_SHOWN = 100_000_000  # nanoseconds; what a busy thread keeps waiting for less has not waited
_DRAWN = 80  # bars, the latest ones
_LEFT, _LENGTH = 1, 540  # user units: before the time lines, and of them
_RIGHT = _LEFT + _LENGTH
_LANE, _BAR, _TOP = 60, 20, 4
_CHARACTER = 7.3  # width of a character of 12 px monospace
_LEAST_BAR = 3
_ROW, _ROWS = 16, 2  # of texts below the bars of a thread: their height, and how many there are at most
_AFTER = 2_000_000_000  # nanoseconds for which what has not ended is drawn at most, after the last thing that happened
_TICKS = 4
_MILLISECOND = 1_000_000


class TimelineBar(NamedTuple):
    """A bar of the drawing."""

    kind: str
    x: int
    y: int
    width: int
    text: str
    anchor: str
    text_x: int
    words: str
    is_open: bool
    row: int = 0  # of the text: above the bar, or in a row below


class Timeline:
    """Time lines that a notebook displays."""

    def __init__(self, events: Sequence[Event], spans: Sequence[Event]) -> None:
        self.busy: list[CallbackSpan] = busy_times(spans, os.getpid())[-_DRAWN:]
        self.waiting: list[MessageWait] = waiting_times(events, self.busy, _WAIT_SHOWN)
        both: list[CallbackSpan | MessageWait] = [*self.busy, *self.waiting]
        ends = [span.end for span in both if span.end is not None]
        begins = [span.begin for span in both]
        self._begin = min(begins, default=0)
        last = max([*ends, *begins, *(event.at for event in events)], default=0)
        is_open = len(ends) < len(begins)
        if is_open:
            last = min(time.monotonic_ns(), last + _AFTER)
        self._length = max(_MILLISECOND, last - self._begin)

    @property
    def lanes(self) -> list[str]:
        """The threads, in the order in which they were first busy."""
        return list(dict.fromkeys(span.lane for span in self.busy))

    def __repr__(self) -> str:
        """What each thread did, in words; repetitions appear once."""
        if not self.busy:
            return _EMPTY
        lines = []
        for lane in self.lanes:
            lines.append(lane)
            spans = [_describe_callback(span) for span in self.busy if span.lane == lane]
            lines += [f"    {text}" for text in dict.fromkeys(spans)]
        if self.waiting:
            lines.append("waiting to be handled")
            lines += [f"    {text}" for text in dict.fromkeys(_how_long(wait) for wait in self.waiting)]
        return "\n".join(lines)

    def html(self) -> str:
        """The drawing as HTML, with the words and times below it."""
        bars: list[TimelineBar] = []
        names, top = [], _TOP
        for lane in self.lanes:
            names.append((lane, top))
            bars += (of_lane := self._bars(lane, top))
            top += _LANE + _ROW * max(bar.row for bar in of_lane)
        if self.waiting:
            names.append(("waiting", top))
        for number, wait in enumerate(self.waiting):
            text = f"{wait.label}{' …' if wait.end is None else ''}"
            bars.append(self._bar("waits", wait, text, top + _LANE * number, self._words(_how_long(wait), wait)))
        height = top + _LANE * len(self.waiting)
        step = self._length / _TICKS
        ticks = [(self._x(self._begin + int(step * number)), _time(int(step * number))) for number in range(_TICKS + 1)]
        words = str(self).splitlines()
        drawing = {"bars": bars, "names": names, "ticks": ticks, "height": height, "width": _RIGHT}
        return str(render_template(_TEMPLATE, words=words, summary=self._summary(), bar=_BAR, row=_ROW, **drawing))

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        if not self.busy:
            return {"text/plain": _EMPTY}
        return {"text/html": self.html(), "text/plain": str(self)}

    def _bars(self, lane: str, top: int) -> list[TimelineBar]:
        found = []
        for span in self.busy:
            if span.lane == lane:
                kind = "failed" if span.failed else "busy"
                text = self._words(_describe_callback(span), span)
                found.append(self._bar(kind, span, _label_callback(span), top, text))
        return _keep_texts_apart(found)

    def _bar(self, kind: str, span: CallbackSpan | MessageWait, text: str, y: int, words: str) -> TimelineBar:
        begin = self._x(span.begin)
        end = self._x(self._begin + self._length if span.end is None else span.end)
        room = len(text) * _CHARACTER
        anchor, text_x = ("start", begin) if begin + room <= _RIGHT else ("end", max(end, begin + _LEAST_BAR))
        return TimelineBar(
            kind, begin, y, max(_LEAST_BAR, end - begin), text, anchor, text_x, words, is_open=span.end is None
        )

    def _x(self, at: int) -> int:
        return round(_LEFT + _LENGTH * (at - self._begin) / self._length)

    def _words(self, said: str, span: CallbackSpan | MessageWait) -> str:
        begin = _time(span.begin - self._begin)
        return f"{said}: from {begin} on" if span.end is None else f"{said}: {begin} to {_time(span.end - self._begin)}"

    def _summary(self) -> str:
        stuck = sum(span.end is None for span in self.busy)
        waits = sum(wait.end is None for wait in self.waiting)
        text = f"Time lines of {len(self.lanes)} thread{'' if len(self.lanes) == 1 else 's'}."
        text += f" {stuck} callback{' has' if stuck == 1 else 's have'} not ended." if stuck else ""
        return text + (f" {waits} message{' is' if waits == 1 else 's are'} not handled." if waits else "")


def _keep_texts_apart(bars: list[TimelineBar]) -> list[TimelineBar]:
    """The bars of a thread; a text that would lie over another bar goes below, or only into its bar's tooltip."""
    above = [(bar.x, bar.x + bar.width) for bar in bars]
    rows: list[list[tuple[float, float]]] = [[] for _ in range(_ROWS + 1)]
    placed: dict[TimelineBar, int] = {}
    # From the right, and those that end at their bars from the left: so a line to a lower row crosses no text.
    for bar in sorted(bars, key=lambda bar: -bar.text_x if bar.anchor == "start" else bar.text_x):
        room = len(bar.text) * _CHARACTER
        begin = bar.text_x if bar.anchor == "start" else bar.text_x - room
        for row, taken in enumerate(rows):
            others = [*taken, *(one for one in above if one != (bar.x, bar.x + bar.width) and not row)]
            way = [one for higher in rows[1:row] for one in higher]
            if _is_free(begin, begin + room, others) and _is_free(bar.text_x, bar.text_x, way):
                taken.append((begin, begin + room + _CHARACTER))
                for higher in rows[1:row]:
                    higher.append((bar.text_x, bar.text_x))
                placed[bar] = row
                break
    return [bar._replace(row=placed[bar]) if bar in placed else bar._replace(text="") for bar in bars]


def _is_free(begin: float, end: float, taken: Iterable[tuple[float, float]]) -> bool:
    return all(end <= before or begin >= after for before, after in taken)


def _label_callback(span: CallbackSpan) -> str:
    return f"{span.node} {span.label}" + (" ✗" if span.failed else " …" if span.end is None else "")


def _describe_callback(span: CallbackSpan) -> str:
    return f"{span.node} {span.label}" + (
        ", and fails" if span.failed else ", and has not ended" if span.end is None else ""
    )


def _how_long(wait: MessageWait) -> str:
    return f"{wait.label}{', which nobody has handled' if wait.end is None else ''}"


def _time(nanoseconds: int) -> str:
    milliseconds = nanoseconds / _MILLISECOND
    if milliseconds < 999.5:  # noqa: PLR2004 - more would be rounded to a thousand
        return f"{milliseconds:.3g} ms"
    return f"{milliseconds / 1000:.3g} s" if milliseconds < 999_500 else f"{milliseconds / 1000:.0f} s"  # noqa: PLR2004

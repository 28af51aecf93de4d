"""A live picture of the ROS graph: who offers what, and who uses it."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

import anywidget
import traitlets
from ipywidgets import VBox

from course_kit import lab
from course_kit.panels.base import RATE, Panel, of_files
from course_kit.panels.other_notebooks import OtherNotebooks
from course_kit.ros import graph
from course_kit.ros.names import short_name

if TYPE_CHECKING:
    from ipywidgets import Widget

    from course_kit.ros.graph import Overview, Use

_PAUSE = 2.0 / RATE  # seconds between two looks; one costs about a millisecond
_JOIN = 2.0
_EMPTY = "No node is on the ROS graph."


class GraphWidget(anywidget.AnyWidget):
    """The picture as the page has it.

    Attributes:
        nodes: each with its `name` and its `uses`: `verb`, `channel` (an index), `inward`.
        channels: each with its `kind`, `name`, `types` and `remarks`.
        text: the same in lines.
        news: what has come or gone since the last change, for a screen reader.
        plumbing: whether what ROS itself brings along is shown.
        ended: whether the picture no longer changes.
    """

    _esm = of_files("graph_view.js")
    _css = of_files("frame.css", "panels.css", "graph_view.css")
    nodes: traitlets.List[dict[str, object]] = traitlets.List().tag(sync=True)
    channels: traitlets.List[dict[str, object]] = traitlets.List().tag(sync=True)
    text = traitlets.Unicode().tag(sync=True)
    news = traitlets.Unicode().tag(sync=True)
    plumbing = traitlets.Bool().tag(sync=True)
    ended = traitlets.Bool().tag(sync=True)


class GraphView(Panel):
    """The ROS graph, looked at five times a second.

    rclpy has no event for changes of the graph, so a thread compares what it sees with what is shown, and tells the
    page only when that has changed.
    """

    def __init__(self) -> None:
        super().__init__()
        self._node = lab.current().engine.node
        self._lock = threading.Lock()
        self._shown: Overview | None = None
        self._ended = threading.Event()
        self.widget = GraphWidget()
        self._others = OtherNotebooks()
        self._came: frozenset[str] = frozenset()  # nodes whose coming is the last news
        self._look()
        self.widget.observe(lambda _: self._look(), "plumbing")
        self._thread = threading.Thread(target=self._watch, name="graph-view", daemon=True)
        self._thread.start()
        self.at_close(self._end)

    def describe(self) -> str:
        """The graph in lines: each node, what it does, and what may be amiss."""
        return in_lines(graph.read(self._node))

    def displayed(self) -> Widget:
        """The picture, and below it what other notebooks run."""
        return VBox([self.widget, self._others.widget])

    def _watch(self) -> None:
        while not self._ended.wait(_PAUSE):
            self._look()
            self._others.show(lab.others())

    def _look(self) -> None:
        with self._lock:  # the page and the thread may ask at the same time
            seen = graph.read(self._node, plumbing=self.widget.plumbing)
            if seen == self._shown:
                return
            before, self._shown = self._shown, seen
            with self.widget.hold_sync():
                self.widget.nodes, self.widget.channels = drawn(seen)
                self.widget.text = in_lines(seen)
                if before is not None and not self._completes(before, seen):
                    self._came = frozenset(seen.nodes) - frozenset(before.nodes)
                    self.widget.news = news(before, seen)

    def _completes(self, before: Overview, now: Overview) -> bool:
        """Whether a change is only what nodes do that have just come: their coming is told, and is the news still."""
        changed = {use.node for use in set(before.uses) ^ set(now.uses)}
        return before.nodes == now.nodes and changed <= self._came

    def _end(self) -> None:
        self._ended.set()
        if threading.current_thread() is not self._thread:
            self._thread.join(_JOIN)
        self.widget.ended = True


def in_lines(seen: Overview) -> str:
    """The graph as text: each node and what it does, then what may be amiss."""
    if not seen.nodes:
        return _EMPTY
    lines = []
    for node in sorted(set(seen.nodes)):
        lines.append(short_name(node) + _how_many(seen.nodes.count(node)))
        uses = seen.of(node)
        lines += [f"    {use.role.verb} {use.channel} [{', '.join(use.types)}]" for use in uses]
    remarks = [remark for said in seen.remarks().values() for remark in said]
    return "\n".join(lines + remarks)


def drawn(seen: Overview) -> tuple[list[dict[str, object]], list[dict[str, object]]]:
    """Nodes and channels as `GraphWidget` has them."""
    channels = dict(sorted(seen.channels().items(), key=lambda item: _height(seen, item[1])))
    places = {key: number for number, key in enumerate(channels)}
    remarks = seen.remarks()
    nodes: list[dict[str, object]] = [
        {
            "name": short_name(node),
            "note": _how_many(seen.nodes.count(node)).strip(),
            "uses": [
                {
                    "verb": use.role.verb,
                    "channel": places[use.role.kind, use.channel],
                    "inward": use.role.inward,
                    "offers": use.role.offers,
                }
                for use in seen.of(node)
            ],
        }
        for node in sorted(set(seen.nodes))
    ]
    return nodes, [
        {
            "kind": kind,
            "name": name,
            "types": sorted({one for use in uses for one in use.types}),
            "remarks": remarks.get((kind, name), []),
        }
        for (kind, name), uses in channels.items()
    ]


def _height(seen: Overview, uses: list[Use]) -> float:
    """How far down its nodes are, so that a channel drawn in this order has them beside it and few lines cross."""
    rows = [seen.uses.index(use) for use in uses]
    return sum(rows) / len(rows)


def news(before: Overview, now: Overview) -> str:
    """What has changed, in a sentence for each node that came or left."""
    came = sorted(set(now.nodes) - set(before.nodes))
    left = sorted(set(before.nodes) - set(now.nodes))
    said = [f"{short_name(node)} has joined the graph." for node in came]
    said += [f"{short_name(node)} has left the graph." for node in left]
    return " ".join(said) or "The graph has changed."


def _how_many(count: int) -> str:
    return f" ({count} nodes of this name)" if count > 1 else ""

"""A live picture of the ROS graph: who offers what, who uses it, and what crosses between them."""

from __future__ import annotations

import threading
from contextlib import suppress
from itertools import filterfalse
from typing import TYPE_CHECKING, NamedTuple

import anywidget
import traitlets

from course_kit import lab
from course_kit.lab.clients import HIDDEN_NAME
from course_kit.panels.base import RATE, LatestValue, Panel, of_files, still
from course_kit.ros import graph
from course_kit.ros.graph import CALLS, LISTENS, PUBLISHES, RUNS, SENDS_GOALS, SERVES, ChannelUse, Overview, Role
from course_kit.ros.graph_drawing import LAB, STYLE_SHEET, graph_svg, how_many
from course_kit.ros.names import is_hidden, short_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.lab.recording.events import Event
    from course_kit.lab.runtime.neighbours import OtherNotebook


class Hop(NamedTuple):
    """One half of a message's way, between a node and a channel."""

    role: Role
    leaves: bool
    stage: int


_HOPS = {
    "published": Hop(PUBLISHES, leaves=True, stage=0),
    "received": Hop(LISTENS, leaves=False, stage=1),
    "request_sent": Hop(CALLS, leaves=True, stage=0),
    "request_received": Hop(SERVES, leaves=False, stage=1),
    "response_sent": Hop(SERVES, leaves=True, stage=2),
    "response_received": Hop(CALLS, leaves=False, stage=3),
    **dict.fromkeys(("goal_sent", "cancel_sent"), Hop(SENDS_GOALS, leaves=True, stage=0)),
    **dict.fromkeys(("goal_received", "cancel_received"), Hop(RUNS, leaves=False, stage=1)),
    **dict.fromkeys(
        ("goal_answered", "feedback_sent", "cancel_answered", "result_sent"), Hop(RUNS, leaves=True, stage=2)
    ),
    **dict.fromkeys(
        ("goal_answer_received", "feedback_received", "cancel_answer_received", "result_received"),
        Hop(SENDS_GOALS, leaves=False, stage=3),
    ),
}


_COMMAND = "_ros2cli_"  # how the names of its nodes begin
_PAUSE = 2.0 / RATE  # seconds between two looks; one costs about a millisecond
_JOIN = 2.0
_EMPTY = "No node is on the ROS graph."
_IN_WORDS = {LAB: "lab, this notebook, with what it has used since this picture began"}


class GraphWidget(anywidget.AnyWidget):
    """The picture as the page has it."""

    _esm = of_files("dom.js", "docking.js", "graph_traffic.js", "graph_view.js")
    _css = of_files("frame.css", "panels.css", STYLE_SHEET, "graph_view.css")
    svg = traitlets.Unicode().tag(sync=True)
    text = traitlets.Unicode().tag(sync=True)
    news = traitlets.Unicode().tag(sync=True)
    crossed: traitlets.Dict[str, object] = traitlets.Dict().tag(sync=True)
    plumbing = traitlets.Bool().tag(sync=True)
    ended = traitlets.Bool().tag(sync=True)


class GraphView(Panel):
    """The ROS graph, looked at five times a second."""

    def __init__(self) -> None:
        super().__init__()
        self._node = lab.current().engine.node
        self._lock = threading.Lock()
        self._shown: Overview | None = None
        self._drawn: tuple[Overview, list[OtherNotebook]] | None = None
        self._of_lab: set[tuple[Role, str]] = set()  # what the notebook itself has sent or got
        self._ended = threading.Event()
        self.widget = GraphWidget()
        self._look()
        self.widget.observe(lambda _: self._look(), "plumbing")
        self._thread = threading.Thread(target=self._watch, name="graph-view", daemon=True)
        self._thread.start()
        self._counting = threading.Lock()
        self._crossed: dict[tuple[str, str, Hop], int] = {}  # what has crossed since the page's last update
        self._updates: LatestValue[None] = LatestValue(lambda _: self._show_crossed())
        self._events = lab.current().events
        self._events.listen(self._observe)
        self.at_close(self._end)

    def describe(self) -> str:
        """The graph's nodes in lines; without the notebook, whose part in it depends on the moment one looks."""
        return in_lines(self._with_hidden(graph.read_graph(self._node)))

    def still(self) -> str:
        """The drawing of this moment."""
        seen = self._with_lab(graph.read_graph(self._node))
        picture = graph_svg(seen, notebooks_by_node(lab.others()))
        return still(in_lines(seen), picture, STYLE_SHEET, title="ROS graph")

    def _watch(self) -> None:
        with suppress(lab.LabError):  # the lab has been closed meanwhile
            while not self._ended.wait(_PAUSE):
                self._look()

    def _look(self) -> None:
        with self._lock:  # the page and the thread may ask at the same time
            seen = graph.read_graph(self._node, plumbing=self.widget.plumbing)
            overview, others = picture = (self._with_lab(seen), lab.others())
            if picture == self._drawn:
                return
            before, self._shown, self._drawn = self._shown, seen, picture
            with self.widget.hold_sync():
                self.widget.svg = graph_svg(overview, notebooks_by_node(others))
                self.widget.text = in_lines(overview)
                if before is not None and (sentence := news(before, seen)):
                    self.widget.news = sentence

    def _with_lab(self, seen: Overview) -> Overview:
        """The graph with the notebook itself, as far as it takes part; without, it is as hidden as ROS hides it."""
        seen = self._with_hidden(seen)
        channels = seen.channels()
        own = [(role, channel) for role, channel in list(self._of_lab) if (role.kind, channel) in channels]
        if not own:
            return seen
        uses = (ChannelUse(LAB, role, channel, channels[role.kind, channel][0].types) for role, channel in own)
        return Overview((*seen.nodes, LAB), (*seen.uses, *sorted(uses, key=lambda use: (use.channel, use.role.verb))))

    def _with_hidden(self, seen: Overview) -> Overview:
        """The graph with the notebooks and commands that are a topic's only other side: ROS hides them, too."""
        looking = self._node
        whose = {f"{HIDDEN_NAME}{other.key.rpartition('/p')[2]}": f"lab of {other.title}" for other in lab.others()}
        sides = {PUBLISHES: looking.get_publishers_info_by_topic, LISTENS: looking.get_subscriptions_info_by_topic}
        found: set[ChannelUse] = set()
        for (kind, topic), uses in seen.channels().items():
            for role in sides.keys() - {use.role for use in uses} if kind == PUBLISHES.kind else ():
                names = {end.node_name for end in sides[role](topic)} - {looking.get_name()}
                hidden = [whose.get(end, "ros2 command") for end in names if end in whose or end.startswith(_COMMAND)]
                found |= {ChannelUse(who, role, topic, uses[0].types) for who in hidden}
        return Overview((*seen.nodes, *sorted({use.node for use in found})), (*seen.uses, *sorted(found)))

    def _observe(self, event: Event) -> None:
        if hop := _HOPS.get(event.kind):
            key = (event.node, event.channel, hop)
            with self._counting:
                self._crossed[key] = self._crossed.get(key, 0) + 1
            self._updates.put(None)

    def _show_crossed(self) -> None:
        with self._counting:
            crossed, self._crossed = self._crossed, {}
        if not crossed:
            return
        own = {(hop.role, channel) for node, channel, hop in crossed if short_name(node) == LAB}
        with self._lock:
            new = own - self._of_lab
            self._of_lab |= own
        if new:
            self._look()
        hops = [
            {
                "node": short_name(node),
                "verb": hop.role.verb,
                "kind": hop.role.kind,
                "channel": channel,
                "leaves": hop.leaves,
                "stage": hop.stage,
                "count": count,
            }
            for (node, channel, hop), count in crossed.items()
        ]
        self.widget.crossed = {"number": int(str(self.widget.crossed.get("number", 0))) + 1, "hops": hops}

    def _end(self) -> None:
        self._ended.set()
        self._events.ignore(self._observe)
        self._updates.close()
        if threading.current_thread() is not self._thread:
            self._thread.join(_JOIN)
        self.widget.ended = True


def notebooks_by_node(others: Sequence[OtherNotebook]) -> dict[str, list[str]]:
    """The titles of the notebooks in which nodes run, one for each node of a name."""
    found: dict[str, list[str]] = {}
    for other in others:
        for node in other.nodes:
            found.setdefault(node, []).append(other.title)
    return found


def news(before: Overview, now: Overview) -> str:
    """A sentence for each node that came or left; hidden ones come and go with the plumbing."""
    came = sorted(filterfalse(is_hidden, set(now.nodes) - set(before.nodes)))
    left = sorted(filterfalse(is_hidden, set(before.nodes) - set(now.nodes)))
    lines = [f"{short_name(node)} has joined the graph." for node in came]
    lines += [f"{short_name(node)} has left the graph." for node in left]
    return " ".join(lines)


def in_lines(seen: Overview) -> str:
    """The graph as text: each node and what it does, then what may be amiss."""
    if not seen.nodes:
        return _EMPTY
    lines = []
    for node in sorted(set(seen.nodes)):
        lines.append(f"{_IN_WORDS.get(node, short_name(node))} {how_many(seen.nodes.count(node))}".rstrip())
        uses = seen.uses_of(node)
        lines += [f"    {use.role.verb} {use.channel} [{', '.join(use.types)}]" for use in uses]
    remarks = [remark for texts in seen.remarks().values() for remark in texts]
    return "\n".join(lines + remarks)

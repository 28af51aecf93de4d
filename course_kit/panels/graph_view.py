"""A live picture of the ROS graph: who offers what, who uses it, and what crosses between them."""

from __future__ import annotations

import html
import threading
import time
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import anywidget
import traitlets
from ipywidgets import HTML, Button, Layout, VBox

from course_kit import lab
from course_kit.panels.base import RATE, Latest, Panel, of_files, still
from course_kit.ros import graph
from course_kit.ros.graph import CALLS, LISTENS, PUBLISHES, RUNS, SENDS_GOALS, SERVES, Overview, Role, Use
from course_kit.ros.graph_drawing import STYLE_SHEET, graph_svg, in_lines
from course_kit.ros.names import short_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ipywidgets import Widget

    from course_kit.lab.recording.events import Event
    from course_kit.lab.runtime.neighbours import OtherNotebook
    from course_kit.ros.graph import Role


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


_PAUSE = 2.0 / RATE  # seconds between two looks; one costs about a millisecond
_JOIN = 2.0
_REMEMBERED = 3.0  # seconds for which the notebook is on the picture at least, after it has sent or got something
_LAB = "lab"  # by this name the recorder reports what the notebook itself sends and gets


class GraphWidget(anywidget.AnyWidget):
    """The picture as the page has it."""

    _esm = of_files("dom.js", "docking.js", "graph_traffic.js", "graph_view.js")
    _css = of_files("frame.css", "panels.css", STYLE_SHEET, "graph_view.css")
    svg = traitlets.Unicode().tag(sync=True)
    text = traitlets.Unicode().tag(sync=True)
    news = traitlets.Unicode().tag(sync=True)
    crossed: traitlets.Dict[str, object] = traitlets.Dict().tag(sync=True)
    wanted = traitlets.Unicode().tag(sync=True)
    plumbing = traitlets.Bool().tag(sync=True)
    ended = traitlets.Bool().tag(sync=True)


class GraphView(Panel):
    """The ROS graph, looked at five times a second."""

    def __init__(self) -> None:
        super().__init__()
        self._node = lab.current().engine.node
        self._lock = threading.Lock()
        self._shown: Overview | None = None
        self._drawn: tuple[Overview, str, frozenset[Use], list[OtherNotebook]] | None = None
        self._of_lab: dict[tuple[Role, str], float] = {}  # what the notebook itself has sent or got, and when
        self._ended = threading.Event()
        self.widget = GraphWidget()
        self._others = OtherNotebooks()
        self._look()
        self.widget.observe(lambda _: self._look(), ["plumbing", "wanted"])
        self._thread = threading.Thread(target=self._watch, name="graph-view", daemon=True)
        self._thread.start()
        self._counting = threading.Lock()
        self._crossed: dict[tuple[str, str, Hop], int] = {}  # what has crossed since the page was last told
        self._updates: Latest[None] = Latest(lambda _: self._show_crossed())
        self._events = lab.current().events
        self._events.listen(self._observe)
        self.at_close(self._end)

    def describe(self) -> str:
        """The graph's nodes in lines; without the notebook, whose part in it depends on the moment one looks."""
        return in_lines(graph.read_graph(self._node))

    def displayed(self) -> Widget:
        """The picture, and below it what other notebooks run."""
        return VBox([self.widget, self._others.widget])

    def still(self) -> str:
        """The drawing of this moment."""
        nodes = graph.read_graph(self._node)
        seen = with_lab(nodes, self._uses_of_lab(nodes))
        return still(in_lines(seen), graph_svg(seen, notebooks_by_node(lab.others())), STYLE_SHEET)

    def _watch(self) -> None:
        with suppress(lab.LabError):  # the lab has been closed meanwhile
            while not self._ended.wait(_PAUSE):
                self._look()
                self._others.show(lab.others())

    def _look(self) -> None:
        with self._lock:  # the page and the thread may ask at the same time
            seen = graph.read_graph(self._node, plumbing=self.widget.plumbing)
            if seen != self._shown:
                self._forget_lab()
            picture = (seen, self.widget.wanted, self._uses_of_lab(seen), lab.others())
            if picture == self._drawn:
                return
            before, self._shown, self._drawn = self._shown, seen, picture
            shown = matching(with_lab(seen, picture[2]), self.widget.wanted)
            with self.widget.hold_sync():
                self.widget.svg = graph_svg(shown, notebooks_by_node(picture[3]))
                self.widget.text = in_lines(shown)
                if before is not None and (said := news(before, seen)):
                    self.widget.news = said

    def _forget_lab(self) -> None:
        """Leave out what the notebook no longer does; only when the picture changes anyway, so that nothing jumps."""
        latest = time.monotonic() - _REMEMBERED
        self._of_lab = {use: at for use, at in self._of_lab.items() if at > latest}

    def _uses_of_lab(self, seen: Overview) -> frozenset[Use]:
        channels = seen.channels()
        known = ((role, channel, channels.get((role.kind, channel))) for role, channel in self._of_lab)
        return frozenset(Use(_LAB, role, channel, uses[0].types) for role, channel, uses in known if uses)

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
        own = {(hop.role, channel) for node, channel, hop in crossed if short_name(node) == _LAB}
        with self._lock:
            new = own - set(self._of_lab)
            self._of_lab.update(dict.fromkeys(own, time.monotonic()))
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


def with_lab(seen: Overview, uses: frozenset[Use]) -> Overview:
    """The graph with the notebook itself on it, as far as it takes part; without, it is as hidden as ROS hides it."""
    if not uses:
        return seen
    return Overview((*seen.nodes, _LAB), (*seen.uses, *sorted(uses, key=lambda use: (use.channel, use.role.verb))))


def matching(seen: Overview, wanted: str) -> Overview:
    """The nodes and channels whose name holds a text, and who is connected to them."""
    text = wanted.strip().lower()
    if not text:
        return seen
    channels = {key for key in seen.channels() if text in key[1].lower()}
    nodes = {node for node in seen.nodes if text in node.lower()}
    channels |= {(use.role.kind, use.channel) for use in seen.uses if use.node in nodes}
    uses = tuple(use for use in seen.uses if (use.role.kind, use.channel) in channels)
    nodes |= {use.node for use in uses}
    return Overview(tuple(node for node in seen.nodes if node in nodes), uses)


def news(before: Overview, now: Overview) -> str:
    """A sentence for each node that came or left."""
    came = sorted(set(now.nodes) - set(before.nodes))
    left = sorted(set(before.nodes) - set(now.nodes))
    said = [f"{short_name(node)} has joined the graph." for node in came]
    said += [f"{short_name(node)} has left the graph." for node in left]
    return " ".join(said)


class OtherNotebooks:
    """A line for each notebook; nothing where there is none."""

    def __init__(self) -> None:
        self.widget = VBox([])
        self._shown: list[OtherNotebook] = []
        self.widget.add_class("ck-others")

    def show(self, others: list[OtherNotebook]) -> None:
        """Show these; a line that has not changed stays as it is."""
        if others == self._shown:
            return
        lines = dict(zip(self._shown, self.widget.children, strict=True))
        self._shown = others
        self.widget.children = tuple(lines[one] if one in lines else _line(one) for one in others)


def _line(other: OtherNotebook) -> VBox:
    text = HTML(f'<span role="status">In another notebook, {html.escape(str(other))}</span>')
    button = Button(description=f"Stop what {other.title} runs", layout=Layout(width="auto"))
    button.on_click(partial(_stop, other.title, text))
    return VBox([text, button], layout=Layout(align_items="flex-start"))


def _stop(title: str, text: HTML, button: Button) -> None:
    """The other one is given seconds to stop, in which this notebook goes on."""
    button.disabled = True

    def stop() -> None:
        try:
            lab.stop_others(title)
        except lab.LabError as problem:
            text.value = f'<span role="status">{html.escape(str(problem))}</span>'
            button.disabled = False

    threading.Thread(target=stop, name="stop-others", daemon=True).start()

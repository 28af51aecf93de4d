"""A live picture of the ROS graph: who offers what, who uses it, and what crosses between them."""

from __future__ import annotations

import html
import itertools
import re
import threading
import time
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import anywidget
import traitlets
from ipywidgets import HTML, Button, Layout, VBox

from course_kit import lab
from course_kit.panels.base import RATE, Latest, Panel, drawn, of_files, still
from course_kit.panels.flow_layout import lay_out
from course_kit.ros import graph
from course_kit.ros.graph import CALLS, LISTENS, PUBLISHES, RUNS, SENDS_GOALS, SERVES, Overview, Role, Use
from course_kit.ros.names import short_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ipywidgets import Widget

    from course_kit.lab.recording.events import Event
    from course_kit.lab.runtime.neighbours import OtherNotebook
    from course_kit.panels.flow_layout import Arrow, Box, Point
    from course_kit.ros.graph import Role

NODE = "node"
_CHARACTER = {"name": 8.0, "kind": 7.3, "types": 7.3, "remark": 7.3}  # width of a character, by its style
_COLUMNS = 30  # characters of a line; longer names are broken
# Where nodes speak to each other in a circle some arrow leads back; a stream of messages is the flow one looks for.
_TURNED_LAST = ("topic", "action", "service")
_LINE, _PADDING = 17, 12
_LEAST_WIDTH = 90.0


class GraphBox(NamedTuple):
    """A node or a channel."""

    kind: str
    name: str
    lines: list[tuple[str, str]]
    words: str
    elsewhere: bool = False

    @property
    def size(self) -> tuple[float, float]:
        """Width and height that its lines need."""
        widest = max(len(text) * _CHARACTER[style] for style, text in self.lines)
        return max(_LEAST_WIDTH, widest + 2 * _PADDING), float(len(self.lines) * _LINE + _PADDING)


def graph_svg(seen: Overview, others: Sequence[OtherNotebook] = ()) -> str:
    """The drawing as an `svg` element, which templates take as it is; empty without nodes."""
    if not seen.nodes:
        return ""
    boxes = boxes_of(seen, others)
    sizes = {key: box.size for key, box in boxes.items()}
    first = sorted(seen.uses, key=lambda use: (_TURNED_LAST.index(use.role.kind), use.role.inward))
    arrows = {_arrow(use): use for use in first}
    found = lay_out(sizes, list(arrows), {key: int(key[0] != NODE) for key in boxes})
    return drawn(
        "graph.svg",
        boxes=[_placed(box, found.places[key]) for key, box in boxes.items()],
        arrows=[_drawn(use, found.ways[arrow]) for arrow, use in arrows.items()],
        width=round(found.size[0]),
        height=round(found.size[1]),
        summary=_summary(seen),
    )


def boxes_of(seen: Overview, others: Sequence[OtherNotebook] = ()) -> dict[Box, GraphBox]:
    """Nodes in alphabetical order, then the channels."""
    boxes: dict[Box, GraphBox] = {(NODE, node): _box_of_node(seen, node, others) for node in sorted(set(seen.nodes))}
    remarks = seen.remarks()
    for (kind, name), uses in seen.channels().items():
        types = sorted({one for use in uses for one in use.types})
        said = remarks.get((kind, name), [])
        lines = [("kind", kind), *(("name", line) for line in _broken(name))]
        lines += [("types", line) for one in types for line in _broken(one)]
        lines += [("remark", line) for one in said for line in _broken(f"⚠ {one}")]
        boxes[kind, name] = GraphBox(kind, name, lines, ". ".join([f"{kind} {name}, {', '.join(types)}", *said]))
    return boxes


def _box_of_node(seen: Overview, node: str, others: Sequence[OtherNotebook]) -> GraphBox:
    name, count = short_name(node), seen.nodes.count(node)
    elsewhere = sum(other.nodes.count(node) for other in others)
    titles = ", ".join(other.title for other in others if node in other.nodes)
    notes = [note for note in (how_many(count), titles and f"in {titles}") if note]
    if elsewhere and elsewhere < count:
        notes[-1] = f"also {notes[-1]}"
    lines = [("name", line) for line in _broken(name)]
    lines += [("types", line) for note in notes for line in _broken(note)]
    does = "; ".join(f"{use.role.verb} {use.channel}" for use in seen.of(node)) or "nothing yet"
    return GraphBox(NODE, name, lines, f"{' '.join([name, *notes])}: {does}", 0 < count <= elsewhere)


def how_many(count: int) -> str:
    """That several nodes carry one name; empty for one."""
    return f"({count} nodes of this name)" if count > 1 else ""


def _arrow(use: Use) -> Arrow:
    node, channel = (NODE, use.node), (use.role.kind, use.channel)
    return (channel, node) if use.role.inward else (node, channel)


def _broken(text: str) -> list[str]:
    """A text in lines, broken at blanks, or behind the parts of a name."""
    lines = [""]
    for part in re.findall(r".+?(?:[\s/_](?=.)|$)", text):
        rest = part
        while len(lines[-1]) + len(rest.rstrip()) > _COLUMNS:
            if lines[-1]:
                lines.append("")
                continue
            lines[-1], rest = rest[:_COLUMNS], rest[_COLUMNS:]
            lines.append("")
        lines[-1] += rest
    return [line.rstrip() for line in lines]


def _placed(box: GraphBox, place: Point) -> dict[str, object]:
    width, height = box.size
    return {**box._asdict(), "x": round(place[0]), "y": round(place[1]), "width": round(width), "height": round(height)}


def _drawn(use: Use, way: list[Point]) -> dict[str, object]:
    """An arrow from left to right, or back: bent between two columns, straight where it crosses one."""
    points = [(round(x), round(y)) for x, y in way]
    step = 9 if points[-1][0] > points[0][0] else -9
    points[-1] = (points[-1][0] - step, points[-1][1])
    path = "M{} {}".format(*points[0])
    for (x, y), (a, b) in itertools.pairwise(points):
        middle = (x + a) // 2
        path += f"C{middle} {y} {middle} {b} {a} {b}"
    x, y = points[-1]
    return {
        "node": short_name(use.node),
        "verb": use.role.verb,
        "kind": use.role.kind,
        "channel": use.channel,
        "offers": use.role.offers,
        "path": path,
        "head": f"M{x + step} {y}l{-step} -5v10z",
    }


def _summary(seen: Overview) -> str:
    counts = [(len(set(seen.nodes)), NODE)]
    kinds: Sequence[str] = [kind for kind, _ in seen.channels()]
    counts += [(kinds.count(kind), kind) for kind in dict.fromkeys(kinds)]
    return "The ROS graph: " + ", ".join(f"{count} {name}{'' if count == 1 else 's'}" for count, name in counts) + "."


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
_EMPTY = "No node is on the ROS graph."
_LAB = "lab"  # by this name the recorder reports what the notebook itself sends and gets


class GraphWidget(anywidget.AnyWidget):
    """The picture as the page has it."""

    _esm = of_files("dom.js", "docking.js", "graph_traffic.js", "graph_view.js")
    _css = of_files("frame.css", "panels.css", "graph_flow.css", "graph_view.css")
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
        return still(in_lines(seen), graph_svg(seen, lab.others()), "graph_flow.css")

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
                self.widget.svg = graph_svg(shown, picture[3])
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


def in_lines(seen: Overview) -> str:
    """The graph as text: each node and what it does, then what may be amiss."""
    if not seen.nodes:
        return _EMPTY
    lines = []
    for node in sorted(set(seen.nodes)):
        lines.append(f"{short_name(node)} {how_many(seen.nodes.count(node))}".rstrip())
        uses = seen.of(node)
        lines += [f"    {use.role.verb} {use.channel} [{', '.join(use.types)}]" for use in uses]
    remarks = [remark for said in seen.remarks().values() for remark in said]
    return "\n".join(lines + remarks)


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

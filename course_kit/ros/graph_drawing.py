"""A drawing of the ROS graph as it flows, for the panel of the graph and for reports; see `templates/graph.svg`."""

from __future__ import annotations

import itertools
import re
import textwrap
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from course_kit.ros.flow_layout import lay_out
from course_kit.ros.names import short_name
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from course_kit.ros.flow_layout import Arrow, Box, Point
    from course_kit.ros.graph import ChannelUse, Overview

NODE = "node"
LAB = "lab"  # stands for the notebook, where it takes part
_CHARACTER = {"name": 8.0, "kind": 7.3, "types": 7.3, "remark": 7.3}  # width of a character, by its style
_COLUMNS = 22  # characters of a line; longer names are broken
# Where nodes speak to each other in a circle some arrow leads back; a stream of messages is the flow one looks for.
_TURNED_LAST = ("topic", "action", "service")
_LINE, _PADDING = 17, 12
_LEAST_WIDTH = 90.0
_NOWHERE: Mapping[str, Sequence[str]] = {}
_TEMPLATES = Path(__file__).with_name("templates")
STYLE_SHEET = _TEMPLATES / "graph.css"  # for the page that shows a drawing


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


def graph_svg(seen: Overview, elsewhere: Mapping[str, Sequence[str]] = _NOWHERE) -> str:
    """The drawing as an `svg` element; `elsewhere` has the titles of other notebooks in which nodes run, by nodes."""
    if not seen.nodes:
        return ""
    boxes = boxes_of(seen, elsewhere)
    sizes = {key: box.size for key, box in boxes.items()}
    first = sorted(seen.uses, key=lambda use: (_TURNED_LAST.index(use.role.kind), use.role.inward))
    arrows = {_arrow(use): use for use in first}
    # What the notebook hears leads back to it, where it sends something, too: else all of it were one long flow.
    found = lay_out(sizes, list(arrows), {key: int(key[0] != NODE) for key in boxes}, (NODE, LAB))
    parts = [f"{count} {kind}{'s' * (count > 1)}" for kind, count in Counter(kind for kind, _ in boxes).items()]
    return render_template(
        _TEMPLATES / "graph.svg",
        boxes=[_place_box(box, found.places[key]) for key, box in boxes.items()],
        arrows=[_draw_arrow(use, found.ways[arrow]) for arrow, use in arrows.items()],
        width=round(found.size[0]),
        height=round(found.size[1]),
        summary=f"The ROS graph: {', '.join(parts)}.",
    )


def boxes_of(seen: Overview, elsewhere: Mapping[str, Sequence[str]] = _NOWHERE) -> dict[Box, GraphBox]:
    """Nodes in alphabetical order, then the channels."""
    boxes: dict[Box, GraphBox] = {}
    for node in sorted(set(seen.nodes)):
        boxes[NODE, node] = _box_of_node(seen, node, elsewhere.get(node, ()))
    remarks = seen.remarks()
    for (kind, name), uses in seen.channels().items():
        types = sorted({kind for use in uses for kind in use.types})
        texts = remarks.get((kind, name), [])
        lines = [("kind", kind), *(("name", line) for line in _break_name(name))]
        lines += [("types", line) for kind in types for line in _break_name(kind)]
        lines += [("remark", line) for text in texts for line in _break_name(f"⚠ {text}")]
        boxes[kind, name] = GraphBox(kind, name, lines, ". ".join([f"{kind} {name}, {', '.join(types)}", *texts]))
    return boxes


def _box_of_node(seen: Overview, node: str, notebooks: Sequence[str]) -> GraphBox:
    name, count = short_name(node), seen.nodes.count(node)
    titles = ", ".join(dict.fromkeys(notebooks))
    notes = [note for note in (how_many(count), titles and f"in {titles}") if note]
    if 0 < len(notebooks) < count:
        notes[-1] = f"also {notes[-1]}"
    lines = [("name", line) for line in _break_name(name)]
    lines += [("types", line) for note in notes for line in _break_name(note)]
    does = "; ".join(f"{use.role.verb} {use.channel}" for use in seen.uses_of(node)) or "nothing yet"
    return GraphBox(NODE, name, lines, f"{' '.join([name, *notes])}: {does}", 0 < count <= len(notebooks))


def how_many(count: int) -> str:
    """That several nodes carry one name; empty for one."""
    return f"({count} nodes of this name)" if count > 1 else ""


def _arrow(use: ChannelUse) -> Arrow:
    node, channel = (NODE, use.node), (use.role.kind, use.channel)
    return (channel, node) if use.role.inward else (node, channel)


class _NameWrapper(textwrap.TextWrapper):
    """Breaks at blanks, and behind the parts of a name."""

    wordsep_simple_re = re.compile(r"(\s+|(?<=\S[/_])(?=.))")


def _break_name(text: str) -> list[str]:
    return _NameWrapper(_COLUMNS, break_on_hyphens=False).wrap(text)


def _place_box(box: GraphBox, place: Point) -> dict[str, object]:
    width, height = box.size
    return {**box._asdict(), "x": round(place[0]), "y": round(place[1]), "width": round(width), "height": round(height)}


def _draw_arrow(use: ChannelUse, way: list[Point]) -> dict[str, object]:
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


def in_sentences(seen: Overview) -> list[str]:
    """Each node and what it does, then what may be amiss."""
    nodes = [box.words for (kind, _), box in boxes_of(seen).items() if kind == NODE]
    return nodes + [remark for texts in seen.remarks().values() for remark in texts]

"""A drawing of the ROS graph as it flows, for the panel of the graph and for reports; see `templates/graph.svg`.

What hangs together stands from left to right, the rest below. Sizes and places are in user units.
"""

from __future__ import annotations

import itertools
import re
import textwrap
from collections import Counter
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from course_kit.ros.names import short_name
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from course_kit.ros.graph import ChannelUse, Overview

    Size = tuple[float, float]
    Point = tuple[float, float]
    Box = tuple[str, str]
    Arrow = tuple[Box, Box]

NODE = "node"
LAB = "lab"  # stands for the notebook, where it takes part
_CHARACTER = {"name": 8.0, "kind": 7.3, "types": 7.3, "remark": 7.3}  # width of a character, by its style
_COLUMNS = 22  # characters of a line; longer names are broken
# Where nodes speak to each other in a circle some arrow leads back; a stream of messages is the flow one looks for.
_TURNED_LAST = ("topic", "action", "service")
_LINE, _PADDING = 17, 12
_LEAST_WIDTH = 90.0
BETWEEN_COLUMNS = 56  # room for the bends of lines, and for what runs along them
BETWEEN_ROWS = 14
_CROSSING = 6  # height that a line takes where it crosses a column
_SWEEPS, _ORDERING = 12, 8  # over the columns, to and fro; the first ones look only at the column they come from
_WIDEST = 700  # parts that do not hang together stand side by side up to this width: that of a docked panel
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
    return render_template(
        _TEMPLATES / "graph.svg",
        boxes=[(box, *map(round, (*found.places[key], *box.size))) for key, box in boxes.items()],
        arrows=[(use, short_name(use.node), *_draw_arrow(found.ways[arrow])) for arrow, use in arrows.items()],
        width=round(found.size[0]),
        height=round(found.size[1]),
        summary=f"The ROS graph: {count_parts(seen)}.",
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


def _draw_arrow(way: list[Point]) -> tuple[str, str]:
    """Line and head of an arrow, from left to right or back: bent between columns, straight where it crosses one."""
    points = [(round(x), round(y)) for x, y in way]
    step = 9 if points[-1][0] > points[0][0] else -9
    points[-1] = (points[-1][0] - step, points[-1][1])
    line = "M{} {}".format(*points[0])
    for (x, y), (a, b) in itertools.pairwise(points):
        middle = (x + a) // 2
        line += f"C{middle} {y} {middle} {b} {a} {b}"
    x, y = points[-1]
    return line, f"M{x + step} {y}l{-step} -5v10z"


def count_parts(seen: Overview) -> str:
    """How many nodes and channels of each kind there are, in words."""
    counts = Counter(kind for kind, _ in boxes_of(seen))
    return ", ".join(f"{count} {kind}{'s' * (count > 1)}" for kind, count in counts.items())


def in_sentences(seen: Overview) -> list[str]:
    """Each node and what it does, then what may be amiss."""
    nodes = [box.words for (kind, _), box in boxes_of(seen).items() if kind == NODE]
    return nodes + [remark for texts in seen.remarks().values() for remark in texts]


class FlowLayout(NamedTuple):
    """The picture."""

    places: dict[Box, Point]
    ways: dict[Arrow, list[Point]]
    size: Size


def lay_out(sizes: Mapping[Box, Size], arrows: Sequence[Arrow], least: Mapping[Box, int], first: Box) -> FlowLayout:
    """Place boxes so that arrows lead from left to right, or back to the first box, and no two boxes overlap."""
    places: dict[Box, Point] = {}
    ways: dict[Arrow, list[Point]] = {}
    x = y = row = widest = 0.0
    for boxes in _find_parts(sizes, arrows):
        own = [each for each in arrows if each[0] in boxes]
        part = _lay_out_part({box: sizes[box] for box in boxes}, own, least, first)
        width, height = part.size
        if x and x + width > _WIDEST:
            x, y, row = 0.0, y + row + 2 * BETWEEN_ROWS, 0.0
        places |= {box: (left + x, top + y) for box, (left, top) in part.places.items()}
        ways |= {arrow: [(left + x, top + y) for left, top in way] for arrow, way in part.ways.items()}
        widest, row = max(widest, x + width), max(row, height)
        x += width + BETWEEN_COLUMNS / 2
    return FlowLayout(places, ways, (widest, y + row))


def _find_parts(boxes: Iterable[Box], arrows: Sequence[Arrow]) -> list[list[Box]]:
    """What hangs together, the largest first."""
    part = {box: {box} for box in boxes}
    for begin, end in arrows:
        joined = part[begin] | part[end]
        part.update(dict.fromkeys(joined, joined))
    found = {id(joined): [box for box in part if box in joined] for joined in part.values()}
    return sorted(found.values(), key=len, reverse=True)


def _lay_out_part(sizes: dict[Box, Size], arrows: Sequence[Arrow], least: Mapping[Box, int], first: Box) -> FlowLayout:
    """Place what hangs together; where a line crosses a column, it has a place there as a box has."""
    boxes, (column_of, back), chains = list(sizes), _choose_columns(sizes, arrows, least, first), {}
    for arrow in arrows:
        begin, end = arrow[::-1] if arrow in back else arrow
        crossed = {(str(arrow), str(number)): number for number in range(column_of[begin] + 1, column_of[end])}
        column_of |= crossed
        chains[arrow] = [begin, *crossed, end]
    columns = [[box for box in column_of if column_of[box] == number] for number in sorted(set(column_of.values()))]
    widths = [max(sizes[box][0] for box in column if box in sizes) for column in columns]
    for column, width in zip(columns, widths, strict=True):
        sizes |= {box: (width, _CROSSING) for box in column if box not in sizes}
    middle = _choose_heights(columns, chains.values(), sizes)
    lefts = [sum(widths[:number]) + BETWEEN_COLUMNS * number for number in range(len(columns))]
    places = {
        box: (left + (width - sizes[box][0]) / 2, middle[box] - sizes[box][1] / 2)
        for column, left, width in zip(columns, lefts, widths, strict=True)
        for box in column
    }

    def end_at(chain: list[Box], side: int, behind: int) -> float:
        """The height at which a line meets a box: there the lines stand in the order of where they lead."""
        lines = [each for each in chains.values() if each[side] == chain[side]]
        lines.sort(key=lambda each: middle[each[behind]])
        top, height = places[chain[side]][1], sizes[chain[side]][1]
        return top + height * (lines.index(chain) + 1) / (len(lines) + 1)

    ways = {}
    for arrow, chain in chains.items():
        passed = [(places[box][0] + x, middle[box]) for box in chain for x in (0, sizes[box][0])]
        way = [(passed[1][0], end_at(chain, 0, 1)), *passed[2:-2], (passed[-2][0], end_at(chain, -1, -2))]
        ways[arrow] = way[::-1] if arrow in back else way
    height = max(middle[box] + sizes[box][1] / 2 for box in places)
    return FlowLayout({box: places[box] for box in boxes}, ways, (lefts[-1] + widths[-1], height))


def _choose_columns(
    sizes: Iterable[Box], arrows: Sequence[Arrow], least: Mapping[Box, int], first: Box
) -> tuple[dict[Box, int], set[Arrow]]:
    """Each box one column behind the last that leads to it; and the arrows that lead back.

    These close a circle with those before them, or lead to the first box, if it begins any.
    """
    before: dict[Box, set[Box]] = {box: set() for box in sizes}
    begins, back = any(begin == first for begin, _ in arrows), set()
    for begin, end in arrows:
        if (begins and end == first) or _closes_circle({**before, end: before[end] | {begin}}):
            back.add((begin, end))
            before[begin].add(end)
        else:
            before[end].add(begin)
    column = {box: least[box] for box in before}
    for box in TopologicalSorter(before).static_order():
        column[box] = max([column[box], *(column[other] + 1 for other in before[box])])
    for box in [box for box in before if not before[box]]:  # what nothing leads to stands right before its next
        column[box] = min((column[other] - 1 for other in before if box in before[other]), default=column[box])
    return column, back


def _closes_circle(before: Mapping[Box, set[Box]]) -> bool:
    try:
        TopologicalSorter(before).prepare()
    except CycleError:
        return True
    return False


def _choose_heights(
    columns: list[list[Box]], chains: Iterable[list[Box]], sizes: Mapping[Box, Size]
) -> dict[Box, float]:
    """The middle of each box: near the middle of its neighbours, in the order of these, and never upon another box."""
    before: dict[Box, list[Box]] = {box: [] for box in sizes}
    behind: dict[Box, list[Box]] = {box: [] for box in sizes}
    for begin, end in itertools.chain.from_iterable(map(itertools.pairwise, chains)):
        before[end].append(begin)
        behind[begin].append(end)
    middle = {box: float(place) for column in columns for place, box in enumerate(column)}
    for sweep in range(_SWEEPS):
        rightwards = sweep % 2 == 0
        for column in columns if rightwards else reversed(columns):
            wanted = {}
            for box in column:
                near = before[box] + behind[box] if sweep >= _ORDERING else before[box] if rightwards else behind[box]
                wanted[box] = sum(middle[other] for other in near or [box]) / len(near or [box])
            column.sort(key=lambda box: wanted[box])
            heights = [sizes[box][1] for box in column]
            middle.update(zip(column, _spread_apart([wanted[box] for box in column], heights), strict=True))
    top = min(middle[box] - sizes[box][1] / 2 for box in middle)
    return {box: value - top for box, value in middle.items()}


def _spread_apart(wanted: list[float], heights: list[float]) -> list[float]:
    """Middles near the wanted ones, in their order, with room between: half way between pushed down and pushed up."""
    distances = [(height + other) / 2 + BETWEEN_ROWS for height, other in itertools.pairwise(heights)]
    down = list(wanted)
    for number, distance in enumerate(distances, 1):
        down[number] = max(down[number], down[number - 1] + distance)
    up = list(wanted)
    for number in range(len(wanted) - 2, -1, -1):
        up[number] = min(up[number], up[number + 1] - distances[number])
    return [(place + other) / 2 for place, other in zip(down, up, strict=True)]

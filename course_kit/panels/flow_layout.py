"""Where boxes and lines of a flow stand, in user units: what hangs together from left to right, the rest below."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, NamedTuple

from course_kit.panels.flow_layers import WAYPOINT, Layers, layers

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from course_kit.panels.flow_layers import Arrow, Box

    Size = tuple[float, float]
    Point = tuple[float, float]

BETWEEN_COLUMNS = 76  # room for the bends of lines, and for what runs along them
BETWEEN_ROWS = 14
_LINE = 6  # height that a line takes where it crosses a column
_PASSES = 8
_WIDEST = 900  # parts that do not hang together stand side by side up to this width


class FlowLayout(NamedTuple):
    """The picture."""

    places: dict[Box, Point]
    ways: dict[Arrow, list[Point]]
    size: Size


def lay_out(sizes: Mapping[Box, Size], arrows: Sequence[Arrow], least: Mapping[Box, int]) -> FlowLayout:
    """Place boxes so that arrows lead from left to right and no two boxes overlap."""
    places: dict[Box, Point] = {}
    ways: dict[Arrow, list[Point]] = {}
    x = y = row = widest = 0.0
    for boxes, own in _parts(list(sizes), arrows):
        part = _place(sizes, layers(boxes, own, least))
        width, height = part.size
        if x and x + width > _WIDEST:
            x, y, row = 0.0, y + row + 2 * BETWEEN_ROWS, 0.0
        places |= {box: (left + x, top + y) for box, (left, top) in part.places.items()}
        ways |= {arrow: [(left + x, top + y) for left, top in way] for arrow, way in part.ways.items()}
        widest, row = max(widest, x + width), max(row, height)
        x += width + BETWEEN_COLUMNS / 2
    return FlowLayout(places, ways, (widest, y + row))


def _parts(boxes: list[Box], arrows: Sequence[Arrow]) -> list[tuple[list[Box], list[Arrow]]]:
    """What hangs together, the largest first."""
    part = {box: number for number, box in enumerate(boxes)}
    for _ in boxes:
        before = dict(part)
        for begin, end in arrows:
            part[begin] = part[end] = min(part[begin], part[end])
        if part == before:
            break
    found = [[box for box in boxes if part[box] == number] for number in sorted(set(part.values()))]
    found.sort(key=len, reverse=True)
    return [(one, [arrow for arrow in arrows if arrow[0] in one]) for one in found]


def _place(sizes: Mapping[Box, Size], found: Layers) -> FlowLayout:
    middles = _heights(sizes, found)
    lefts, left = [], 0.0
    widths = [max(_size(sizes, box)[0] for box in column) for column in found.columns]
    for width in widths:
        lefts.append(left)
        left += width + BETWEEN_COLUMNS
    column_of = {box: number for number, column in enumerate(found.columns) for box in column}
    places = {
        box: (lefts[column_of[box]] + (widths[column_of[box]] - sizes[box][0]) / 2, middles[box] - sizes[box][1] / 2)
        for box in column_of
        if box[0] != WAYPOINT
    }
    bands = {box: (lefts[number], lefts[number] + widths[number]) for box, number in column_of.items()}
    ways = {arrow: _way(arrow, found, places, sizes, (middles, bands)) for arrow in found.chains}
    height = max(places[box][1] + sizes[box][1] for box in places)
    height = max([height, *(point[1] for way in ways.values() for point in way)])
    return FlowLayout(places, ways, (left - BETWEEN_COLUMNS, height))


def _size(sizes: Mapping[Box, Size], box: Box) -> Size:
    return (0.0, _LINE) if box[0] == WAYPOINT else sizes[box]


def _heights(sizes: Mapping[Box, Size], found: Layers) -> dict[Box, float]:
    """The middle of each box: near the middle of its neighbours, and never upon another box."""
    middle: dict[Box, float] = {}
    for column in found.columns:
        top = 0.0
        for box in column:
            middle[box] = top + _size(sizes, box)[1] / 2
            top += _size(sizes, box)[1] + BETWEEN_ROWS
    near: dict[Box, list[Box]] = {}
    for chain in found.chains.values():
        for begin, end in itertools.pairwise(chain):
            near.setdefault(begin, []).append(end)
            near.setdefault(end, []).append(begin)
    for number in range(_PASSES):
        for column in found.columns if number % 2 == 0 else reversed(found.columns):
            wanted = [
                sum(middle[one] for one in near[box]) / len(near[box]) if near.get(box) else middle[box]
                for box in column
            ]
            heights = [_size(sizes, box)[1] for box in column]
            middle.update(zip(column, _apart(wanted, heights), strict=True))
    top = min(middle[box] - _size(sizes, box)[1] / 2 for box in middle)
    return {box: value - top for box, value in middle.items()}


def _apart(wanted: list[float], heights: list[float]) -> list[float]:
    """Middles near the wanted ones, in their order, with room between: half way between pushed down and pushed up."""
    distances = [(one + other) / 2 + BETWEEN_ROWS for one, other in itertools.pairwise(heights)]
    down = list(wanted)
    for number, distance in enumerate(distances, 1):
        down[number] = max(down[number], down[number - 1] + distance)
    up = list(wanted)
    for number in range(len(wanted) - 2, -1, -1):
        up[number] = min(up[number], up[number + 1] - distances[number])
    return [(one + other) / 2 for one, other in zip(down, up, strict=True)]


def _way(
    arrow: Arrow,
    found: Layers,
    places: Mapping[Box, Point],
    sizes: Mapping[Box, Size],
    lines: tuple[Mapping[Box, float], Mapping[Box, tuple[float, float]]],
) -> list[Point]:
    """The points an arrow passes; it ends on a box at a place of its own."""
    middles, bands = lines
    chain = found.chains[arrow]
    begin, end = chain[0], chain[-1]
    leaving = [one for one in found.chains.values() if one[0] == begin]
    coming = [one for one in found.chains.values() if one[-1] == end]
    leaving.sort(key=lambda one: middles[one[1]])
    coming.sort(key=lambda one: middles[one[-2]])
    start = (
        places[begin][0] + sizes[begin][0],
        places[begin][1] + sizes[begin][1] * (leaving.index(chain) + 1) / (len(leaving) + 1),
    )
    stop = (places[end][0], places[end][1] + sizes[end][1] * (coming.index(chain) + 1) / (len(coming) + 1))
    crossed = [(x, middles[box]) for box in chain[1:-1] for x in bands[box]]
    way = [start, *crossed, stop]
    return way[::-1] if arrow in found.turned else way

"""Where boxes and lines of a flow stand, in user units: what hangs together from left to right, the rest below."""

from __future__ import annotations

import itertools
from statistics import fmean as mean
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    Size = tuple[float, float]
    Point = tuple[float, float]
    Box = tuple[str, str]
    Arrow = tuple[Box, Box]

WAYPOINT = "waypoint"  # the first half of a box that is only the place of a line in a column it crosses
_SWEEPS = 12


class Layers(NamedTuple):
    """Columns of boxes."""

    columns: list[list[Box]]
    chains: dict[Arrow, list[Box]]
    turned: frozenset[Arrow]


def layers(boxes: Sequence[Box], arrows: Sequence[Arrow], least: Mapping[Box, int]) -> Layers:
    """The columns of boxes that hang together."""
    turned = frozenset(_find_back_arrows(boxes, arrows))
    forward = [(end, begin) if (begin, end) in turned else (begin, end) for begin, end in arrows]
    column_of = _columns(boxes, forward, least)
    columns: list[list[Box]] = [[] for _ in range(max(column_of.values()) + 1)]
    for box in boxes:
        columns[column_of[box]].append(box)
    chains = {}
    for arrow, (begin, end) in zip(arrows, forward, strict=True):
        between = range(column_of[begin] + 1, column_of[end])
        way = [(WAYPOINT, f"{number} {begin} {end} {arrow in turned}") for number in between]
        for number, waypoint in zip(between, way, strict=True):
            columns[number].append(waypoint)
        chains[arrow] = [begin, *way, end]
    return Layers(_order_columns([column for column in columns if column], chains.values()), chains, turned)


def _find_back_arrows(boxes: Sequence[Box], arrows: Sequence[Arrow]) -> set[Arrow]:
    """Arrows that close a circle with those before them."""
    reached = {box: {box} for box in boxes}  # from each, along the arrows so far
    turned: set[Arrow] = set()
    for begin, end in arrows:
        if begin in reached[end]:
            turned.add((begin, end))
            continue
        for found in reached.values():
            if begin in found:
                found.update(reached[end])
    return turned


def _columns(boxes: Sequence[Box], arrows: Sequence[Arrow], least: Mapping[Box, int]) -> dict[Box, int]:
    """Each box one column behind the last that leads to it; what nothing leads to stands right before its next."""
    column = {box: least[box] for box in boxes}
    for _ in boxes:  # the longest way has no more steps than there are boxes
        before = dict(column)
        for begin, end in arrows:
            column[end] = max(column[end], column[begin] + 1)
        if column == before:
            break
    ends = {end for _, end in arrows}
    for box in boxes:
        following = [column[end] for begin, end in arrows if begin == box]
        if box not in ends and following:
            column[box] = min(following) - 1
    return column


def _order_columns(columns: list[list[Box]], chains: Iterable[list[Box]]) -> list[list[Box]]:
    """The columns, each in the order of its neighbours in the column before or behind, after some sweeps."""
    left: dict[Box, list[Box]] = {}
    right: dict[Box, list[Box]] = {}
    for chain in chains:
        for begin, end in itertools.pairwise(chain):
            left.setdefault(end, []).append(begin)
            right.setdefault(begin, []).append(end)
    for sweep in range(_SWEEPS):
        order = range(1, len(columns)) if sweep % 2 == 0 else range(len(columns) - 2, -1, -1)
        neighbours, step = (left, -1) if sweep % 2 == 0 else (right, 1)
        for number in order:
            places = {box: place for place, box in enumerate(columns[number + step])}
            own = {box: place for place, box in enumerate(columns[number])}
            columns[number].sort(key=lambda box: mean([places[end] for end in neighbours.get(box, ())] or [own[box]]))
    return columns


BETWEEN_COLUMNS = 56  # room for the bends of lines, and for what runs along them
BETWEEN_ROWS = 14
_LINE = 6  # height that a line takes where it crosses a column
_PASSES = 8
_WIDEST = 630  # parts that do not hang together stand side by side up to this width: that of a docked panel


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
    return [(boxes, [arrow for arrow in arrows if arrow[0] in boxes]) for boxes in found]


def _place(sizes: Mapping[Box, Size], found: Layers) -> FlowLayout:
    sizes = {**{box: (0.0, _LINE) for column in found.columns for box in column if box[0] == WAYPOINT}, **sizes}
    middles = _heights(sizes, found)
    lefts, left = [], 0.0
    widths = [max(sizes[box][0] for box in column) for column in found.columns]
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
    ways = {arrow: _draw_way(arrow, found, places, sizes, (middles, bands)) for arrow in found.chains}
    height = max(places[box][1] + sizes[box][1] for box in places)
    height = max([height, *(point[1] for way in ways.values() for point in way)])
    return FlowLayout(places, ways, (left - BETWEEN_COLUMNS, height))


def _heights(sizes: Mapping[Box, Size], found: Layers) -> dict[Box, float]:
    """The middle of each box: near the middle of its neighbours, and never upon another box."""
    middle: dict[Box, float] = {}
    for column in found.columns:
        top = 0.0
        for box in column:
            middle[box] = top + sizes[box][1] / 2
            top += sizes[box][1] + BETWEEN_ROWS
    near: dict[Box, list[Box]] = {}
    for chain in found.chains.values():
        for begin, end in itertools.pairwise(chain):
            near.setdefault(begin, []).append(end)
            near.setdefault(end, []).append(begin)
    for number in range(_PASSES):
        for column in found.columns if number % 2 == 0 else reversed(found.columns):
            wanted = [mean([middle[other] for other in near.get(box, ())] or [middle[box]]) for box in column]
            heights = [sizes[box][1] for box in column]
            middle.update(zip(column, _spread_apart(wanted, heights), strict=True))
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


def _draw_way(
    arrow: Arrow,
    found: Layers,
    places: Mapping[Box, Point],
    sizes: Mapping[Box, Size],
    lines: tuple[Mapping[Box, float], Mapping[Box, tuple[float, float]]],
) -> list[Point]:
    """The points an arrow passes; it ends on a box at its own place."""
    middles, bands = lines
    chain = found.chains[arrow]
    begin, end = chain[0], chain[-1]
    leaving = [chain for chain in found.chains.values() if chain[0] == begin]
    coming = [chain for chain in found.chains.values() if chain[-1] == end]
    leaving.sort(key=lambda chain: middles[chain[1]])
    coming.sort(key=lambda chain: middles[chain[-2]])
    start = (
        places[begin][0] + sizes[begin][0],
        places[begin][1] + sizes[begin][1] * (leaving.index(chain) + 1) / (len(leaving) + 1),
    )
    stop = (places[end][0], places[end][1] + sizes[end][1] * (coming.index(chain) + 1) / (len(coming) + 1))
    crossed = [(x, middles[box]) for box in chain[1:-1] for x in bands[box]]
    way = [start, *crossed, stop]
    return way[::-1] if arrow in found.turned else way

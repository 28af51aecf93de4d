"""Where boxes and lines of a flow stand, in user units: what hangs together from left to right, the rest below."""

from __future__ import annotations

import itertools
from statistics import fmean as mean
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    Size = tuple[float, float]
    Point = tuple[float, float]
    Box = tuple[str, str]
    Arrow = tuple[Box, Box]

BETWEEN_COLUMNS = 56  # room for the bends of lines, and for what runs along them
BETWEEN_ROWS = 14
_LINE = 6  # height that a line takes where it crosses a column
_SWEEPS, _ORDERING = 12, 8  # over the columns, to and fro; the first ones look only at the column they come from
_WIDEST = 700  # parts that do not hang together stand side by side up to this width: that of a docked panel


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
    boxes, turned = list(sizes), _find_back_arrows(sizes, arrows, first)
    forward = {arrow: arrow[::-1] if arrow in turned else arrow for arrow in arrows}
    column_of = _choose_columns(boxes, forward.values(), least)
    chains = {}
    for arrow, (begin, end) in forward.items():
        crossed = {(str(arrow), str(number)): number for number in range(column_of[begin] + 1, column_of[end])}
        column_of |= crossed
        chains[arrow] = [begin, *crossed, end]
    columns = [[box for box in column_of if column_of[box] == number] for number in sorted(set(column_of.values()))]
    widths = [max(sizes[box][0] for box in column if box in sizes) for column in columns]
    for column, width in zip(columns, widths, strict=True):
        sizes |= {box: (width, _LINE) for box in column if box not in sizes}
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
        ways[arrow] = way[::-1] if arrow in turned else way
    height = max(middle[box] + sizes[box][1] / 2 for box in places)
    return FlowLayout({box: places[box] for box in boxes}, ways, (lefts[-1] + widths[-1], height))


def _find_back_arrows(boxes: Iterable[Box], arrows: Sequence[Arrow], first: Box) -> set[Arrow]:
    """Arrows that close a circle with those before them, and those that lead to the first box, if it begins any."""
    begins = any(begin == first for begin, _ in arrows)
    reached = {box: {box} for box in boxes}  # from each, along the arrows so far
    turned = set()
    for begin, end in arrows:
        if begin in reached[end] or (begins and end == first):
            turned.add((begin, end))
        else:
            for found in reached.values():
                if begin in found:
                    found.update(reached[end])
    return turned


def _choose_columns(boxes: Collection[Box], arrows: Collection[Arrow], least: Mapping[Box, int]) -> dict[Box, int]:
    """Each box one column behind the last that leads to it; what nothing leads to stands right before its next."""
    column = {box: least[box] for box in boxes}
    for begin, end in [*arrows] * len(boxes):  # the longest way has no more steps than there are boxes
        column[end] = max(column[end], column[begin] + 1)
    for box in set(boxes).difference(end for _, end in arrows):
        column[box] = min((column[end] - 1 for begin, end in arrows if begin == box), default=column[box])
    return column


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
                wanted[box] = mean([middle[other] for other in near or [box]])
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

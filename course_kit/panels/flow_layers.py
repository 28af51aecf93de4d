"""Puts the boxes of a flow into columns and brings them into an order in which few lines cross.

The usual way for drawings that flow (Sugiyama's): turn a few arrows so that no circle is left, give each box the
column behind all that lead to it, let a line that crosses a column have a place of its own in it, then order each
column by where its neighbours stand. The same boxes and arrows always give the same picture.
"""

from __future__ import annotations

import itertools
from bisect import bisect_right, insort
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

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
    turned = frozenset(_turned(boxes, arrows))
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
    return Layers(_ordered([column for column in columns if column], chains.values()), chains, turned)


def _turned(boxes: Sequence[Box], arrows: Sequence[Arrow]) -> set[Arrow]:
    """Arrows that close a circle with those before them."""
    after: dict[Box, list[Box]] = {box: [] for box in boxes}
    turned: set[Arrow] = set()
    for begin, end in arrows:
        if _leads_to(begin, end, after):
            turned.add((begin, end))
        else:
            after[begin].append(end)
    return turned


def _leads_to(wanted: Box, begin: Box, after: Mapping[Box, list[Box]]) -> bool:
    seen, left = {begin}, [begin]
    while left:
        following = [box for box in after[left.pop()] if box not in seen]
        seen.update(following)
        left += following
    return wanted in seen


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


def _ordered(columns: list[list[Box]], chains: Iterable[list[Box]]) -> list[list[Box]]:
    """The columns, each in the order with the fewest crossings that some sweeps have found."""
    left: dict[Box, list[Box]] = {}
    right: dict[Box, list[Box]] = {}
    for chain in chains:
        for begin, end in itertools.pairwise(chain):
            left.setdefault(end, []).append(begin)
            right.setdefault(begin, []).append(end)
    best, fewest = columns, _crossings(columns, right)
    for sweep in range(_SWEEPS):
        if not fewest:
            break
        columns = [list(column) for column in columns]
        order = range(1, len(columns)) if sweep % 2 == 0 else range(len(columns) - 2, -1, -1)
        neighbours, step = (left, -1) if sweep % 2 == 0 else (right, 1)
        for number in order:
            places = {box: place for place, box in enumerate(columns[number + step])}
            own = {box: place for place, box in enumerate(columns[number])}
            columns[number].sort(key=lambda box: _mean([places[one] for one in neighbours.get(box, ())], own[box]))
        crossings = _crossings(columns, right)
        if crossings < fewest:
            best, fewest = columns, crossings
    return best


def _mean(values: Sequence[float], otherwise: float) -> float:
    return sum(values) / len(values) if values else otherwise


def _crossings(columns: list[list[Box]], right: Mapping[Box, list[Box]]) -> int:
    """How many pairs of lines cross."""
    count = 0
    for column, following in itertools.pairwise(columns):
        places = {box: place for place, box in enumerate(following)}
        seen: list[int] = []
        for box in column:
            ends = [places[one] for one in right.get(box, ()) if one in places]
            count += sum(len(seen) - bisect_right(seen, end) for end in ends)
            for end in ends:
                insort(seen, end)
    return count

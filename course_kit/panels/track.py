"""The way something has taken, kept short enough to be sent to a browser ten times a second."""

from __future__ import annotations

import math
from typing import NamedTuple

STRAIGHT = 0.005  # metres a point may lie beside the straight way past it
LONGEST = 400  # corners; the oldest go first
_STRETCH = 300  # places one straight line stands for at most: each is looked at again when the line grows


class Place(NamedTuple):
    """A point of the arena, in metres."""

    x: float
    y: float


class Track:
    """A line through every place that was reported; places on a straight way are left out."""

    def __init__(self) -> None:
        self._corners: list[Place] = []
        self._skipped: list[Place] = []

    @property
    def corners(self) -> list[Place]:
        """The line's points, the oldest first."""
        return list(self._corners)

    def add(self, place: Place) -> None:
        """Go on to a place."""
        if not (math.isfinite(place.x) and math.isfinite(place.y)):
            return
        if self._corners and place == self._corners[-1]:
            return
        if len(self._corners) > 1 and len(self._skipped) < _STRETCH and self._is_straight_to(place):
            self._skipped.append(self._corners[-1])
            self._corners[-1] = place
        else:
            self._skipped.clear()
            self._corners.append(place)
            del self._corners[:-LONGEST]

    def _is_straight_to(self, place: Place) -> bool:
        """Whether the line's last point may be moved on: all places it stands for lie beside the new line."""
        begin = self._corners[-2]
        between = [*self._skipped, self._corners[-1]]
        return all(_beside(begin, place, one) <= STRAIGHT for one in between)


def _beside(begin: Place, end: Place, place: Place) -> float:
    """How far a place lies from the straight way between two others, in metres."""
    length = math.dist(begin, end)
    if not (length**2):  # nor where it is too short to be squared
        return math.dist(begin, place)
    along = ((place.x - begin.x) * (end.x - begin.x) + (place.y - begin.y) * (end.y - begin.y)) / length**2
    along = min(max(along, 0.0), 1.0)
    foot = (begin.x + along * (end.x - begin.x), begin.y + along * (end.y - begin.y))
    return math.dist(foot, place)

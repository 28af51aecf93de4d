"""Ways through the arena for exercise 2: where to send the robot, and what feedback of a move is worth."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import random
    from collections.abc import Sequence

    from geometry_msgs.msg import Point

    from course_kit.grading.checks.actions import ReceivedFeedback

ARENA = 10.0  # metres; 0 <= x, y <= ARENA
TOLERANCE = 0.05  # metres; how near to the target a move has to end
BESIDE = 0.1  # metres; how far from the straight way a position may lie
BARELY_BEGUN, NEARLY_DONE = 0.1, 0.99  # the progress that the first message says at most, and the last at least
_A_METRE = 5  # feedback messages
_ROUNDING = 1e-6
_DRAWS = 24
_ROUNDS = 5
_APART = 0.12  # of the way, by which two distances differ that are not taken for each other
_GOOD_PART = 0.4


class MovePlace(NamedTuple):
    """A place in the arena, in metres."""

    x: float
    y: float

    def __str__(self) -> str:
        return f"({self.x:.2f}, {self.y:.2f})"


ORIGIN = MovePlace(0.0, 0.0)
# Where the robot is kept: far from (0, 0), which fields hold that nobody filled in, and from the corner opposite.
_LEAST, _MOST = 0.6, 5.6


def target_from(here: MovePlace, length: float, random: random.Random) -> MovePlace:
    """A target `length` metres away (5 at most), drawn from those in the middle of the arena where there are any.

    Args:
        here: where the robot is.
        length: in metres.
        random: what is drawn from.
    """
    return _most_central(_drawn(here, length, random))


def telling_target(here: MovePlace, length: float, driven: float, random: random.Random) -> MovePlace:
    """As `target_from`, and where it can be had a target that tells mistaken distances apart.

    These are the way from the origin, which is what a new robot for each goal measures, and all ways together.

    Args:
        here: where the robot is.
        length: of the way, in metres.
        driven: the ways so far together, in metres.
        random: what is drawn from.
    """

    def tells(target: MovePlace) -> bool:
        mistaken = math.dist(ORIGIN, target)
        return min(abs(mistaken - length), abs(mistaken - driven - length)) > _APART * length

    drawn = [place for _ in range(_ROUNDS) for place in _drawn(here, length, random)]
    return _most_central([place for place in drawn if tells(place)] or drawn)


def in_the_arena(place: MovePlace) -> MovePlace:
    """The place itself, or of one outside of the arena, or with a NaN, the nearest that a robot can be at."""
    x, y = (0.0 if math.isnan(value) else min(max(value, 0.0), ARENA) for value in place)
    return MovePlace(x, y)


def _drawn(here: MovePlace, length: float, random: random.Random) -> list[MovePlace]:
    drawn: list[MovePlace] = []
    while not drawn:
        for _ in range(_DRAWS):
            angle = random.uniform(0.0, 2.0 * math.pi)
            drawn.append(MovePlace(here.x + length * math.cos(angle), here.y + length * math.sin(angle)))
        drawn = [place for place in drawn if all(0.0 <= value <= ARENA for value in place)]
    return drawn


def _most_central(places: Sequence[MovePlace]) -> MovePlace:
    return next((place for place in places if all(_LEAST <= value <= _MOST for value in place)), places[0])


def farthest_corner(here: MovePlace) -> MovePlace:
    """A place near a corner of the arena, the farthest away: 6 m at least. The edges are a check of their own."""
    corners = [MovePlace(x, y) for x in (_LEAST, ARENA - _LEAST) for y in (_LEAST, ARENA - _LEAST)]
    return max(corners, key=lambda corner: math.dist(here, corner))


def nearest_corner(here: MovePlace) -> MovePlace:
    """The corner of the arena that is nearest; it lies on two of its edges."""
    return MovePlace(*(0.0 if value < ARENA / 2 else ARENA for value in here))


def opposite(corner: MovePlace) -> MovePlace:
    """The corner that lies on the other two edges."""
    return MovePlace(*(ARENA - value for value in corner))


def enough_feedback(length: float) -> int:
    """How many feedback messages a move brings at least, by its length in metres."""
    return math.floor(_A_METRE * length + _ROUNDING)


def place_of(point: Point) -> MovePlace:
    """The place of a geometry_msgs/Point."""
    return MovePlace(point.x, point.y)


def beside(begin: MovePlace, end: MovePlace, place: MovePlace) -> float:
    """How far a place lies from the straight way between two others, in metres; NaN for a place that is none.

    Args:
        begin: one end.
        end: the other one.
        place: the place.
    """
    way = math.dist(begin, end)
    if way == 0.0:
        return math.dist(begin, place)
    along = ((place.x - begin.x) * (end.x - begin.x) + (place.y - begin.y) * (end.y - begin.y)) / way**2
    along = min(max(along, 0.0), 1.0)
    nearest = MovePlace(begin.x + along * (end.x - begin.x), begin.y + along * (end.y - begin.y))
    return math.dist(nearest, place)


def is_spread(times: Sequence[float], began: float, over: float) -> bool:
    """Whether feedback came all along a move.

    From the first to the last it has to take a good part of the move (a robot may get under way late), with at least
    one message in the middle third of that.

    Args:
        times: when it was received, while the move went on; by the same clock as the other two.
        began: when the move began.
        over: when it was over.
    """
    if not times:
        return False
    first, last = times[0], times[-1]
    third = (last - first) / 3.0
    between = any(first + third <= time <= last - third for time in times)
    return between and last - first >= _GOOD_PART * (over - began)


def jump(feedback: Sequence[ReceivedFeedback]) -> str:
    """The first two messages between which progress falls or the distance left grows; empty when there are none."""
    values = [one.feedback for one in feedback]
    for value in values:
        if not -_ROUNDING <= value.progress <= 1.0 + _ROUNDING:
            return f"progress={value.progress!r}, which is not between 0 and 1"
    for before, after in itertools.pairwise(values):
        if not after.progress >= before.progress - _ROUNDING:
            return f"progress={before.progress!r}, then {after.progress!r}"
        if not after.distance_remaining <= before.distance_remaining + _ROUNDING:
            return f"distance_remaining={before.distance_remaining!r}, then {after.distance_remaining!r}"
    return ""

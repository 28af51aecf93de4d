"""Exercise 2: places in the arena, and what a client can see of a move: its feedback and its end."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from course_interfaces.action import MoveRobot

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.goals import CANCELED, SUCCEEDED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.checks.actions import ReceivedFeedback
    from course_kit.grading.checks.goals import CheckedGoal, Ended

ARENA = 10.0  # metres; 0 <= x, y <= ARENA
TOLERANCE = 0.05  # metres; how near to the target a move has to end
BESIDE = 0.1  # metres; how far from the straight way a position may lie
_LONG_M = 1.0  # from this length on feedback has to come
_A_METRE = 5  # feedback messages
_BARELY_BEGUN = 0.1  # the progress that the first message says at most
_FITS = 0.05  # how well progress fits distance_remaining
_JUDGED_M = 0.5  # shorter moves' progress depends too much on where the robot stopped before
_ROUNDING = 1e-6
_SAME = 0.005  # of progress
_GOOD_PART = 0.4  # of the time of a move, from the first to the last feedback
_NEAR_M = 0.5  # metres; a robot that reports five times a metre was seen so near to where it went


class HastyError(Failed):
    """A fault that might not show with the robot at its own speed: a learner's own clock keeps real time."""


class ArenaPoint(NamedTuple):
    """A place in the arena, in metres."""

    x: float
    y: float

    def __str__(self) -> str:
        return f"({self.x:.2f}, {self.y:.2f})"


ORIGIN = ArenaPoint(0.0, 0.0)


@dataclass(frozen=True)
class Move:
    """A move that has ended SUCCEEDED."""

    begin: ArenaPoint
    target: ArenaPoint
    goal: CheckedGoal
    ended: Ended

    @property
    def length(self) -> float:
        """The straight way, in metres."""
        return math.dist(self.begin, self.target)


def place_of(point: Any) -> ArenaPoint:
    """The place of a geometry_msgs/Point."""
    return ArenaPoint(point.x, point.y)


def in_the_arena(place: ArenaPoint) -> ArenaPoint:
    """The place itself, or the nearest that a robot can be at."""
    return ArenaPoint(*(0.0 if math.isnan(value) else min(max(value, 0.0), ARENA) for value in place))


def misses(place: ArenaPoint, target: ArenaPoint) -> bool:
    """Whether a place is not the target, within the tolerance; NaN misses."""
    return not math.dist(place, target) <= TOLERANCE


def is_blank(result: Any) -> bool:
    """Whether a result is as ROS 2 makes it: nobody has filled in anything."""
    return bool(result == MoveRobot.Result())


def describe_end(ended: Ended) -> str:
    """The end of a goal as the learner is shown it."""
    result = ended.result
    return (
        f"{ended.name}, final_position=({result.final_position.x:.4g}, {result.final_position.y:.4g}), "
        f"distance_travelled={result.distance_travelled:.4g}"
    )


def beside(begin: ArenaPoint, end: ArenaPoint, place: ArenaPoint) -> float:
    """How far a place lies from the straight way between two others, in metres; NaN for a place that is none."""
    way = math.dist(begin, end)
    if way == 0.0:
        return math.dist(begin, place)
    along = ((place.x - begin.x) * (end.x - begin.x) + (place.y - begin.y) * (end.y - begin.y)) / way**2
    along = min(max(along, 0.0), 1.0)
    nearest = ArenaPoint(begin.x + along * (end.x - begin.x), begin.y + along * (end.y - begin.y))
    return math.dist(nearest, place)


def require_enough(move: Move) -> None:
    """A move of 1 m or more comes with enough feedback, all along.

    Raises:
        HastyError: it does not.
    """
    if move.length < _LONG_M:
        return
    enough = math.floor(_A_METRE * move.length + _ROUNDING)
    heard = move.goal.wait_for_last_feedback(lambda messages: len(messages) >= enough)
    expected = f"at least {enough} feedback messages, spread over the move of {move.length:.2g} m"
    if len(heard) < enough:
        count = f"{len(heard)} feedback message{'' if len(heard) == 1 else 's'}"
        why = f"A client saw {count} of a move of {move.length:.2g} m."
        raise HastyError(Evidence(move.goal.shown, expected, count), why, "action.no_feedback")
    times = sorted(one.came_s for one in heard)  # one that got lost and was sent again is the latest
    began, over = move.goal.began_at or times[0], move.goal.over_at or times[-1]
    got = f"{len(times)} messages, {times[0] - began:.2f} s to {times[-1] - began:.2f} s after the start"
    evidence = Evidence(move.goal.shown, expected, f"{got}; the goal ended after {over - began:.2f} s")
    if not is_spread([time for time in times if time <= over], began, over):
        raise HastyError(evidence, "The messages came in one burst, not spread over the move.", "action.late_feedback")


def require_sense(move: Move) -> None:
    """What feedback says of a move is true.

    Raises:
        Failed: it is not.
    """
    long = move.length >= _LONG_M
    heard = move.goal.wait_for_last_feedback(lambda messages: not long or _is_complete(messages))
    expected = f"progress from 0 to 1, distance_remaining shrinking, {move.begin} to {move.target}"
    if not heard:
        if long:
            why = "There was no feedback during this move."
            raise HastyError(Evidence(move.goal.shown, expected, "no feedback"), why)
        return
    if found := find_jump(heard):
        evidence = Evidence(move.goal.shown, expected, found)
        why = f"Two messages of one move contradict each other: {found}." if "then" in found else f"It was {found}."
        raise Failed(evidence, why, "action.feedback_not_monotonic")
    for feedback in (one.feedback for one in heard):
        _require_on_the_way(move, feedback)
    if not long:
        return
    first, last = heard[0].feedback, heard[-1].feedback
    got = f"{len(heard)} messages, progress={first.progress:.4g} to {last.progress:.4g}"
    evidence = Evidence(move.goal.shown, f"{expected}; progress at most {_BARELY_BEGUN} at first", got)
    if not last.distance_remaining <= TOLERANCE:
        why = f"The last feedback said progress={last.progress:.4g}: publish one more when the robot arrives."
        raise HastyError(evidence, why)
    begun = 1.0 - math.dist(place_of(first.position), move.target) / move.length
    if min(first.progress, begun) > _BARELY_BEGUN + _ROUNDING:
        why = f"The first feedback said progress={first.progress:.4g}: publish one before a tenth of the way is done."
        raise HastyError(evidence, why)
    for feedback in (one.feedback for one in heard):
        wanted = 1.0 - feedback.distance_remaining / move.length
        if not abs(feedback.progress - wanted) <= _FITS + _ROUNDING:
            got = f"progress={feedback.progress:.4g} with distance_remaining={feedback.distance_remaining:.4g}"
            wanted_text = f"progress within {_FITS} of {wanted:.3g}: {move.length:.3g} m is this goal's whole way"
            why = f"progress={feedback.progress:.4g} is not the part of this goal's own way that is done."
            raise HastyError(Evidence(move.goal.shown, wanted_text, got), why)


def require_limits(goal: CheckedGoal) -> None:
    """Progress stays in 0 to 1 where there is no way to go and no feedback is needed.

    Raises:
        Failed: a message said something else.
    """
    for one in goal.wait_for_last_feedback(lambda _: True):
        progress = one.feedback.progress
        if not -_ROUNDING <= progress <= 1.0 + _ROUNDING:
            evidence = Evidence(goal.shown, "progress from 0 to 1, if there is feedback", f"progress={progress:.4g}")
            why = "A goal at the present position needs no feedback, but progress goes from 0 to 1."
            raise Failed(evidence, why, breaks="already_there")


def explain_z(move: Move, z: float) -> str:
    """Which figure of a wrong move counts z; empty when none does."""
    if _counts(move.ended.result.distance_travelled, move.length, z):
        return f"distance_travelled counts z, which is {z:g} in this target: z has to be ignored."
    for feedback in (one.feedback for one in move.goal.feedback):
        left = math.dist(place_of(feedback.position), move.target)
        if _counts(feedback.distance_remaining, left, z):
            return f"distance_remaining counts z, which is {z:g} in this target: z has to be ignored."
        if _is_progress_with_z(feedback.progress, 1.0 - left / move.length, (left, move.length), z):
            return f"progress counts z, which is {z:g} in this target: z has to be ignored."
    return ""


def require_stopped(goal: CheckedGoal, ended: Ended, evidence: Evidence, begin: ArenaPoint, target: ArenaPoint) -> None:
    """A goal whose cancelling was accepted ended CANCELED where the robot can have stopped.

    Raises:
        Failed: it did not.
    """
    stopped, seen = place_of(ended.result.final_position), _last_seen(goal, begin, target)
    if not misses(stopped, target) and ended.status in (SUCCEEDED, CANCELED):
        if seen is not None and math.dist(seen, target) > _NEAR_M:
            why = f"The result says that the robot is at the target, but the last feedback said that it was at {seen}."
            raise HastyError(evidence, why)
        why = "Your server agreed to cancel the goal, but the robot drove on to its target."
        raise HastyError(evidence, why, "action.cancel_ignored")
    goal.require_status(ended, CANCELED, evidence)
    moved = seen is not None and math.dist(begin, seen) > BESIDE
    if is_blank(ended.result) and (moved or math.dist(begin, (0.0, 0.0)) > BESIDE):  # else it may be the truth
        why = "The result still has its default values: your callback set none of its fields when it was cancelled."
        raise Failed(evidence, why)
    if not beside(begin, target, stopped) <= BESIDE:
        raise Failed(evidence, f"The robot was driving from {begin} to {target}, so it cannot have stopped there.")
    if seen is not None and math.dist(begin, stopped) < math.dist(begin, seen) - BESIDE:
        why = f"The last feedback said {seen}, but the result says {stopped}: the robot cannot have driven back."
        raise Failed(evidence, why)


def _last_seen(goal: CheckedGoal, begin: ArenaPoint, target: ArenaPoint) -> ArenaPoint | None:
    """Where feedback last said that the robot was on its way; what lies beside it is another check's matter."""
    seen = [place_of(one.feedback.position) for one in goal.feedback]
    return next((place for place in reversed(seen) if beside(begin, target, place) <= BESIDE), None)


def _is_complete(heard: Sequence[ReceivedFeedback]) -> bool:
    return bool(heard) and heard[-1].feedback.distance_remaining <= TOLERANCE


def is_spread(times: Sequence[float], began: float, over: float) -> bool:
    """Whether feedback took a good part of a move, with one in the middle third of that."""
    if not times:
        return False
    first, last = times[0], times[-1]
    third = (last - first) / 3.0
    between = any(first + third <= time <= last - third for time in times)
    return between and last - first >= _GOOD_PART * (over - began)


def find_jump(feedback: Sequence[ReceivedFeedback]) -> str:
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


def _require_on_the_way(move: Move, feedback: Any) -> None:
    place = place_of(feedback.position)
    off = beside(move.begin, move.target, place)
    blank = " Was feedback.position filled in?" if place == (0.0, 0.0) else ""
    if not off <= BESIDE:
        evidence = Evidence(move.goal.shown, f"positions within {BESIDE} m of the straight line", f"{place}")
        raise Failed(evidence, f"This position lies {off:.2g} m away from the straight line to the target.{blank}")
    left = math.dist(place, move.target)
    if not abs(feedback.distance_remaining - left) <= BESIDE:
        wanted = f"distance_remaining within {BESIDE} m of {left:.3g} m, the way from {place}"
        evidence = Evidence(move.goal.shown, wanted, f"distance_remaining={feedback.distance_remaining:.4g}")
        # The robot may have moved between the two; at its own speed not that far.
        why = "The distance left is not that from the position in the same message to the target."
        raise HastyError(evidence, f"{why}{blank}")


def _counts(value: float, right: float, z: float) -> bool:
    """Whether a distance is one in x, y and z; what is wrong in another way is not."""
    return math.isnan(value) or abs(value - math.hypot(right, z)) <= BESIDE < abs(value - right)


def _is_progress_with_z(value: float, right: float, ways: tuple[float, float], z: float) -> bool:
    """Whether a progress was made from the way left, the whole way, or both in x, y and z."""
    if math.isnan(value) or abs(value - right) <= BESIDE:
        return math.isnan(value)
    left, whole = ((way, math.hypot(way, z)) for way in ways)
    return any(abs(value - (1.0 - one / other)) <= _SAME for one in left for other in whole)


def is_right(aspect: str, move: Move) -> bool:
    try:
        judge(aspect, move)
    except Failed:
        return False
    return True


def judge(aspect: str, move: Move, breaks: str = "") -> None:
    """One aspect of a move that ended SUCCEEDED is right."""
    judge = {
        "arrives": _require_arrived,
        "distance": _require_distance,
        "feedback": require_enough,
        "progress": require_sense,
    }[aspect]
    try:
        judge(move)
    except Failed as failed:
        failed.breaks = breaks or aspect
        raise


def _require_arrived(move: Move) -> None:
    final = place_of(move.ended.result.final_position)
    expected = f"SUCCEEDED, final_position within {TOLERANCE} m of {move.target}"
    evidence = Evidence(move.goal.shown, expected, describe_end(move.ended))
    if not misses(final, move.target):
        return
    if is_blank(move.ended.result):
        raise Failed(evidence, "The result still has its default values: your callback set none of its fields.")
    off = math.dist(final, move.target)
    raise Failed(evidence, f"The robot ended {off:.3g} m away from the target.", "action.stops_short")


def _require_distance(move: Move) -> None:
    travelled = move.ended.result.distance_travelled
    tolerance = max(TOLERANCE, 0.05 * move.length)
    expected = f"distance_travelled within {tolerance:.3g} m of {move.length:.3g} m, the way from {move.begin}"
    evidence = Evidence(move.goal.shown, expected, describe_end(move.ended))
    if abs(travelled - move.length) <= tolerance:
        return
    if abs(travelled - math.dist(ORIGIN, move.target)) <= tolerance:
        why = f"That is the distance from {ORIGIN}, but the robot was at {move.begin} when this goal arrived."
    elif travelled > move.length:
        why = "distance_travelled is more than this move: does it count earlier moves, too?"
    elif travelled == 0.0:
        why = "The field was not filled in."
    else:
        why = "That is less than the straight line to the target."
    raise Failed(evidence, why)

"""What a client sees of a move in exercise 2 while it goes on."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from course_kit.graders._driving import LONGEST_M, SHORTEST_M, HastyError, Move, by_the_last_move
from course_kit.graders._moves import (
    BARELY_BEGUN,
    BESIDE,
    NEARLY_DONE,
    ORIGIN,
    beside,
    enough_feedback,
    is_spread,
    jump,
    place_of,
)
from course_kit.grading.checks.check import Evidence, Failed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_interfaces.action import MoveRobot

    from course_kit.grading.checks.actions import ReceivedFeedback
    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.goals import CheckedGoal

_SAME = 0.005  # of progress
_ROUNDING = 1e-9  # of progress


def feedback_of_a_move(context: CheckContext) -> Evidence:
    """A move comes with enough feedback, all along.

    Raises:
        Failed: it does not.
    """
    return by_the_last_move(context, _require_enough, LONGEST_M)


def _require_enough(move: Move) -> Evidence:
    enough = enough_feedback(move.length)
    heard = move.goal.wait_for_last_feedback(lambda all_told: len(all_told) >= enough)
    expected = f"at least {enough} feedback messages, spread over the move of {move.length:.2g} m"
    if len(heard) < enough:
        told_so = f"{len(heard)} feedback message{'' if len(heard) == 1 else 's'}"
        message = f"A client saw {told_so} of a move of {move.length:.2g} m."
        raise HastyError(Evidence(move.goal.shown, expected, told_so), message, "action.no_feedback")
    times = sorted(one.came_s for one in heard)  # one that got lost and was sent again is the latest
    began, over = move.goal.began_at or times[0], move.goal.over_at or times[-1]
    got = f"{len(times)} messages, {times[0] - began:.2f} s to {times[-1] - began:.2f} s after the start"
    evidence = Evidence(move.goal.shown, expected, f"{got}; the goal ended after {over - began:.2f} s")
    if not is_spread([time for time in times if time <= over], began, over):
        message = "The messages came in one burst, not spread over the move."
        raise HastyError(evidence, message, "action.late_feedback")
    return evidence


def progress_of_a_move(context: CheckContext) -> Evidence:
    """What feedback tells of a move makes sense.

    Raises:
        Failed: it does not.
    """
    return by_the_last_move(context, _require_sense, SHORTEST_M)


def _require_sense(move: Move) -> Evidence:
    heard = move.goal.wait_for_last_feedback(_is_complete)
    expected = (
        f"progress from {BARELY_BEGUN} or less to {NEARLY_DONE} or more, distance_remaining shrinking, "
        f"{move.begin} to {move.target}"
    )
    if not heard:
        raise HastyError(Evidence(move.goal.shown, expected, "no feedback"), "There was no feedback during this move.")
    if found := jump(heard):
        evidence = Evidence(move.goal.shown, expected, found)
        message = f"Two messages of one move contradict each other: {found}." if "then" in found else f"It was {found}."
        raise Failed(evidence, message, "action.feedback_not_monotonic")
    for feedback in (one.feedback for one in heard):
        _require_on_the_way(move, feedback)
    first, last = heard[0].feedback.progress, heard[-1].feedback.progress
    evidence = Evidence(move.goal.shown, expected, f"{len(heard)} messages, progress={first:.4g} to {last:.4g}")
    if last < NEARLY_DONE:
        message = f"The goal succeeded, but its last feedback said progress={last:.4g}: tell when the robot is there."
        raise HastyError(evidence, message)
    if first > BARELY_BEGUN:
        message = f"The first feedback said progress={first:.4g}: tell it before a tenth of the way is done."
        raise HastyError(evidence, message)
    return evidence


def require_no_z(move: Move, z: float) -> None:
    """What is said of a move does not depend on the target's z.

    Args:
        move: a move that is over.
        z: the target's, in metres, or NaN.

    Raises:
        Failed: it depends on it. Whether it is right otherwise is a check of its own.
    """
    travelled = move.ended.result.distance_travelled
    if _counts(travelled, move.length, z):
        raise _counts_z(move, z, "distance_travelled", move.length, travelled)
    for feedback in (one.feedback for one in move.goal.wait_for_last_feedback(_is_complete)):
        if not beside(move.begin, move.target, place_of(feedback.position)) <= BESIDE:
            continue  # a position that is wrong tells nothing of the rest
        left = math.dist(place_of(feedback.position), move.target)
        if _counts(feedback.distance_remaining, left, z):
            raise _counts_z(move, z, "distance_remaining", left, feedback.distance_remaining)
        done = 1.0 - left / move.length
        if _is_progress_with_z(feedback.progress, done, (left, move.length), z):
            raise _counts_z(move, z, "progress", done, feedback.progress)


def require_progress_limits(goal: CheckedGoal) -> None:
    """Progress goes from 0 to 1, also where there is no way to go and no feedback is needed.

    Raises:
        Failed: a message said something else.
    """
    for told in goal.wait_for_last_feedback(lambda _: True):
        progress = told.feedback.progress
        if not -_ROUNDING <= progress <= 1.0 + _ROUNDING:
            evidence = Evidence(goal.shown, "progress from 0 to 1, if there is feedback", f"progress={progress:.4g}")
            raise Failed(evidence, "A goal at the present position needs no feedback, but progress goes from 0 to 1.")


def _is_complete(heard: Sequence[ReceivedFeedback]) -> bool:
    """Whether the last message says that the robot is there."""
    return bool(heard) and heard[-1].feedback.progress >= NEARLY_DONE


def _require_on_the_way(move: Move, feedback: MoveRobot.Feedback) -> None:
    place = place_of(feedback.position)
    off = beside(move.begin, move.target, place)
    if not off <= BESIDE:
        evidence = Evidence(move.goal.shown, f"positions within {BESIDE} m of the straight line", f"{place}")
        blank = " Was feedback.position filled in?" if place == ORIGIN else ""
        raise Failed(evidence, f"This position lies {off:.2g} m away from the straight line to the target.{blank}")
    left = math.dist(place, move.target)
    if not abs(feedback.distance_remaining - left) <= BESIDE:
        wanted = f"distance_remaining within {BESIDE} m of {left:.3g} m, the way from {place}"
        evidence = Evidence(move.goal.shown, wanted, f"distance_remaining={feedback.distance_remaining:.4g}")
        # The robot may have moved between the two; at its own speed not that far.
        message = "The distance left is not that from the position in the same message to the target."
        raise HastyError(evidence, message)


def _counts(told: float, right: float, z: float) -> bool:
    """Whether a distance is one in x, y and z; what is wrong in another way is not."""
    return math.isnan(told) or abs(told - math.hypot(right, z)) <= BESIDE < abs(told - right)


def _is_progress_with_z(told: float, right: float, ways: tuple[float, float], z: float) -> bool:
    """Whether a progress was made from the way left, the whole way, or both in x, y and z."""
    if math.isnan(told) or abs(told - right) <= BESIDE:
        return math.isnan(told)
    left, whole = ((way, math.hypot(way, z)) for way in ways)
    return any(abs(told - (1.0 - one / other)) <= _SAME for one in left for other in whole)


def _counts_z(move: Move, z: float, field: str, right: float, told: float) -> Failed:
    evidence = Evidence(move.goal.shown, f"{field}={right:.3g}, whatever z is", f"{field}={told:.4g}")
    return Failed(evidence, f"{field} counts z, which is {z:g} in this target: z has to be ignored.")

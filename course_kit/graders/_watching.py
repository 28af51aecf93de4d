"""What a client sees of a move in exercise 2 while it goes on."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from course_kit.graders._driving import LONGEST_M, SHORTEST_M, HastyError, Move, drive_on
from course_kit.graders._moves import BESIDE, ENOUGH, NEARLY_DONE, ORIGIN, beside, is_spread, jump, place_of
from course_kit.grading.checks.check import Evidence, Failed

if TYPE_CHECKING:
    from course_kit.grading.checks.context import CheckContext


def feedback_of_a_move(context: CheckContext) -> Evidence:
    """A move comes with enough feedback, all along.

    Raises:
        Failed: it does not.
    """
    move = drive_on(context, LONGEST_M)
    heard = move.goal.wait_for_last_feedback(lambda all_told: len(all_told) >= ENOUGH)
    expected = f"at least {ENOUGH} feedback messages, spread over the move of {move.length:.2g} m"
    if len(heard) < ENOUGH:
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
    move = drive_on(context, SHORTEST_M)
    heard = move.goal.wait_for_last_feedback(
        lambda all_told: bool(all_told) and all_told[-1].feedback.progress >= NEARLY_DONE
    )
    expected = (
        f"progress from 0 up to {NEARLY_DONE} or more, distance_remaining shrinking, {move.begin} to {move.target}"
    )
    if not heard:
        raise HastyError(Evidence(move.goal.shown, expected, "no feedback"), "There was no feedback during this move.")
    if found := jump(heard):
        evidence = Evidence(move.goal.shown, expected, found)
        message = f"Two messages of one move contradict each other: {found}." if "then" in found else f"It was {found}."
        raise Failed(evidence, message, "action.feedback_not_monotonic")
    for feedback in (one.feedback for one in heard):
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
    last = heard[-1].feedback
    evidence = Evidence(move.goal.shown, expected, f"{len(heard)} messages, the last with progress={last.progress:.4g}")
    if last.progress < NEARLY_DONE:
        raise HastyError(evidence, f"The goal succeeded, but its last feedback said progress={last.progress:.4g}.")
    return evidence


def require_no_z(move: Move, z: float) -> None:
    """What feedback says of the distance left does not depend on the target's z.

    Args:
        move: a move that is over.
        z: the target's, in metres, or NaN.

    Raises:
        Failed: it depends on it. Whether it is right otherwise is a check of its own.
    """
    for feedback in (one.feedback for one in move.goal.wait_for_last_feedback(bool)):
        place, told = place_of(feedback.position), feedback.distance_remaining
        left = math.dist(place, move.target)
        with_z = math.hypot(left, z)
        if math.isnan(told) if math.isnan(z) else abs(told - with_z) <= BESIDE < abs(told - left):
            wanted = f"distance_remaining={left:.3g} at {place}, whatever z is"
            evidence = Evidence(move.goal.shown, wanted, f"distance_remaining={told:.4g}")
            raise Failed(evidence, f"The distance left counts z, which is {z:g} in this target: it has to be ignored.")

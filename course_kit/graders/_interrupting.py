"""What may come between a goal and its end in exercise 2: a second goal, and a request to cancel."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from course_kit.graders._driving import (
    HastyError,
    allowed_s,
    arrive,
    at_own_speed,
    here,
    is_at,
    is_blank,
    misses,
    send,
    set_off,
    told,
)
from course_kit.graders._moves import BESIDE, MovePlace, beside, farthest_corner, place_of, target_from
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.discovery import ENDED
from course_kit.grading.checks.goals import CANCELED, SUCCEEDED, CheckedGoal, Ended
from course_kit.grading.diagnosis import goals, hangs
from course_kit.grading.diagnosis.exceptions import explained

if TYPE_CHECKING:
    from course_kit.grading.checks.context import CheckContext

_PROMPT_S = 1.0  # within which a cancel request is answered
_FIRST_M, _SECOND_M = 2.4, 1.0  # metres; the ways of two goals at a time
_LONG_M = 4.0  # metres; a move that is cancelled with the robot at its own speed
_AT_ONCE_M = 1.0  # metres; the ways of two goals that are sent in the same instant
_PAIRS = 3  # of them: which callback comes first is a matter of chance
_NEAR_M = 0.5  # metres; a robot that tells five times a metre was seen so near to where it went


def second_goal_of_two(context: CheckContext) -> Evidence:
    """A second goal is rejected, and the first reaches its target all the same.

    Raises:
        Failed: both are accepted, or the first is lost.
    """
    begin = here(context)
    first = set_off(context, target_from(begin, _FIRST_M, context.random))
    _get_under_way(context, first, begin)
    second = send(context, target_from(begin, _SECOND_M, context.random))
    expected = "the second goal rejected while the first runs"
    second.wait_for_answer(expected, allowed_s(_FIRST_M))
    waited_s = second.clock.wall()
    sent = f"{first.shown}; under way, {second.shown}"
    if second.accepted:
        raise _both_accepted(context, first, second, waited_s, Evidence(sent, expected, "both goals accepted"))
    arrive(context, first, _FIRST_M)
    return Evidence(sent, expected, expected)


def two_at_once(context: CheckContext) -> Evidence:
    """Of two goals that are sent in the same instant one is accepted, and reaches its target.

    Raises:
        Failed: both are accepted, or none is.
    """
    expected = "one of the two goals accepted, the other rejected"
    for _ in range(_PAIRS):
        begin = here(context)
        pair = [send(context, target_from(begin, _AT_ONCE_M, context.random)) for _ in range(2)]
        for goal in pair:
            goal.wait_for_answer(expected, allowed_s(_AT_ONCE_M))
        sent = f"{pair[0].shown}; in the same instant {pair[1].shown}"
        accepted = [goal for goal in pair if goal.accepted]
        if not accepted:
            message = "The robot was free, so one of the two goals has to be accepted."
            raise Failed(Evidence(sent, expected, "both rejected"), message)
        if len(accepted) > 1:
            # With a fast robot the first may be over before the second one arrives, and its end is told a little later.
            message = "The second goal arrived before your node had noted down that it has one."
            raise HastyError(Evidence(sent, expected, "both goals accepted"), message)
        arrive(context, accepted[0], _AT_ONCE_M)
    return Evidence(sent, expected, expected)


def cancel_midway(context: CheckContext) -> Evidence:
    """A goal is cancelled on its way and ends CANCELED where the robot is then."""
    begin = here(context)
    target = target_from(begin, _LONG_M, context.random) if at_own_speed(context) else farthest_corner(begin)
    goal = set_off(context, target)
    _get_under_way(context, goal, begin)
    expected = "cancelling accepted within 1 s, then CANCELED short of the target"
    goal.shown += ", and mid-way the request to cancel it"
    length = math.dist(begin, target)
    _have_it_accepted(context, goal, length, expected)
    ended = goal.wait_for_end(allowed_s(length), expected)
    evidence = Evidence(goal.shown, expected, told(ended))
    stopped = place_of(ended.result.final_position)
    _require_canceled(goal, ended, evidence, (begin, target))
    _require_stopped(goal, ended, evidence, begin, target)
    is_at(context, stopped)
    return evidence


def _get_under_way(context: CheckContext, goal: CheckedGoal, begin: MovePlace) -> None:
    """Wait until the robot has driven a little: as feedback tells, or long enough for a robot that says nothing."""
    way, seconds = (1.0, 1.2) if at_own_speed(context) else (0.3, 0.15)

    def under_way() -> bool:
        return (
            goal.over_at is not None
            or goal.clock.wall() > seconds
            or any(math.dist(begin, place_of(one.feedback.position)) >= way for one in goal.feedback)
        )

    with explained(context, Evidence(goal.shown, "the robot to drive"), goals.of_program, ENDED):
        context.wait_until(under_way, allowed_s(way))


def _both_accepted(
    context: CheckContext, first: CheckedGoal, second: CheckedGoal, waited_s: float, evidence: Evidence
) -> Failed:
    def interleaved() -> bool:
        return bool(second.feedback and first.feedback and first.feedback[-1].came_s > second.feedback[0].came_s)

    context.wait_until(lambda: interleaved() or first.over_at is not None, allowed_s(_FIRST_M))
    if interleaved():
        message = "Feedback of both goals arrived in turns: your node drives one robot to two targets."
        return Failed(evidence, message, "action.concurrent_goals")
    context.wait_until(lambda: bool(second.statuses), hangs.LOOK_S)
    over = first.over_at
    if over is None or over > second.began_at:
        return Failed(evidence, "Your server accepted a second goal while the first was running.")
    if any(status == SUCCEEDED for _, status in first.statuses):
        if waited_s > _PROMPT_S:
            message = f"Your server did not answer the second goal for {waited_s:.1f} s, until the first was over."
            return HastyError(evidence, message, "action.cancel_blocked")
        return HastyError(evidence, f"The first goal, {_FIRST_M:g} m long, was over before the second arrived.")
    return Failed(
        evidence, "Your server ended the first goal when the second arrived. It has to reject the second instead."
    )


def _have_it_accepted(context: CheckContext, goal: CheckedGoal, length: float, expected: str) -> None:
    """Ask to cancel the goal, and have that accepted in time."""
    clock = context.clock()
    answer = goal.cancel()
    with explained(context, Evidence(goal.shown, expected), goals.of_program, "no answer: the program ended"):
        context.wait_until(answer.answered, allowed_s(length))
    if not answer.answered():
        raise hangs.unanswered(context, goal.shown, expected, clock.fair())
    waited_s, late = clock.wall(), clock.past(_PROMPT_S)
    if goal.is_cancelled_by(answer.response()):
        if late:
            evidence = Evidence(goal.shown, expected, f"accepted after {waited_s:.1f} s")
            message = (
                f"Your server answered the request to cancel only after {waited_s:.1f} s: that is too "
                "late to stop a robot."
            )
            raise HastyError(evidence, message, "action.cancel_blocked")
        return
    if goal.over_at is None:
        message = "Your server refused to cancel the goal, and the goal went on."
        raise Failed(Evidence(goal.shown, expected, "cancelling refused"), message, "action.cancel_refused")
    evidence = Evidence(goal.shown, expected, f"an answer after {waited_s:.1f} s, when the goal was over")
    if waited_s > _PROMPT_S:
        message = "Your server did not answer the request to cancel before the move was over."
        raise HastyError(evidence, message, "action.cancel_blocked")
    raise HastyError(
        evidence,
        f"The move, {length:.1f} m long, was over before the request to cancel arrived: is your robot too fast?",
    )


def _require_canceled(goal: CheckedGoal, ended: Ended, evidence: Evidence, way: tuple[MovePlace, MovePlace]) -> None:
    """The goal was ended as CANCELED, short of its target."""
    begin, target = way
    at_target = not misses(place_of(ended.result.final_position), target)
    if at_target and ended.status in (SUCCEEDED, CANCELED):
        seen = _last_seen(goal, begin, target)
        if seen is not None and math.dist(seen, target) > _NEAR_M:
            message = (
                f"The result says that the robot is at the target, but the last feedback said that it was at {seen}."
            )
            raise HastyError(evidence, message)
        message = "Your server agreed to cancel the goal, but the robot drove on to its target."
        raise HastyError(evidence, message, "action.cancel_ignored")
    goal.require_status(ended, CANCELED, evidence)


def _require_stopped(goal: CheckedGoal, ended: Ended, evidence: Evidence, begin: MovePlace, target: MovePlace) -> None:
    """The final position can be where the robot has stopped."""
    stopped, seen = place_of(ended.result.final_position), _last_seen(goal, begin, target)
    if is_blank(ended.result):
        raise Failed(
            evidence, "The result is as ROS 2 creates it: your callback filled in nothing when the goal was cancelled."
        )
    if not beside(begin, target, stopped) <= BESIDE:
        message = f"The robot was driving from {begin} to {target}, so it cannot have stopped there."
        raise Failed(evidence, message)
    if seen is not None and math.dist(begin, stopped) < math.dist(begin, seen) - BESIDE:
        message = f"The last feedback said {seen}, but the result says {stopped}: the robot cannot have driven back."
        raise Failed(evidence, message)


def _last_seen(goal: CheckedGoal, begin: MovePlace, target: MovePlace) -> MovePlace | None:
    """Where feedback last said that the robot was on its way; what lies beside it is another check's matter."""
    seen = [place_of(one.feedback.position) for one in goal.feedback]
    return next((place for place in reversed(seen) if beside(begin, target, place) <= BESIDE), None)

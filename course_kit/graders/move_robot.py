"""Exercise 2: the action /move_robot, which drives a simulated robot, observed over ROS.

What is wanted: goals in the arena are reached with feedback on the way, impossible ones and a second one at a time are
rejected, and a goal can be cancelled mid-way. The robot is made fast by COURSE_KIT_TIME_SCALE; what a learner's own
clock might have spoiled is repeated with the robot at its own speed before it counts.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from course_kit.graders._driving import (
    ACTION,
    FAST,
    LONGEST_M,
    REACHED,
    SHORTEST_M,
    Move,
    arrive,
    at_own_speed,
    by_the_last_move,
    drive,
    drive_on,
    driven,
    fairly,
    here,
    is_blank,
    longest_way,
    misses,
    reject_all_or_some,
    send,
    set_off,
    told,
)
from course_kit.graders._interrupting import cancel_midway, second_goal_of_two, two_at_once
from course_kit.graders._moves import (
    ARENA,
    ORIGIN,
    TOLERANCE,
    MovePlace,
    nearest_corner,
    opposite,
    place_of,
    telling_target,
)
from course_kit.graders._watching import feedback_of_a_move, progress_of_a_move, require_no_z, require_progress_limits
from course_kit.grading.checks.check import Check, Evidence, Failed, check

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.goals import CheckedGoal

INTERFACES = (ACTION.interface,)
VARIABLES = FAST
_SHORT_M = 0.4  # metres; a move where nothing but its end matters
_AT_ONCE_S = 1.0  # a goal at the present position
_TOO_STRICT = "validation.overzealous"
_CORNER = "corner"  # remembered of the running submission: one that it has driven to
_EDGE_M = 0.01  # how near outside the arena we test


@check(points=1.0, depends_on=["offered"], proves=["reaches", "a_program"])
def accepted(context: CheckContext) -> Evidence:
    """A goal in the arena is accepted.

    Raises:
        Failed: it is not.
    """
    target = MovePlace(0.3, 0.2)
    goal = send(context, target)
    goal.wait_for_answer("the goal accepted")
    if not goal.accepted:
        raise reject_all_or_some(context, goal, [MovePlace(2.0, 1.0), MovePlace(5.0, 5.0)])
    try:
        arrive(context, goal, longest_way(context, target))
        _look_at_the_nearest_edges(context)
    except Failed:
        context.spoil()  # how a goal ends is the next check's matter; it gets a fresh program
    return Evidence(goal.shown, "the goal accepted", "the goal accepted")


@check(points=2.0, depends_on=["accepted"], deadline_s=30.0, proves=["reaches", "in_time"])
def succeeds(context: CheckContext) -> Evidence:
    """A goal in the arena ends SUCCEEDED, with a result."""
    move = drive_on(context, SHORTEST_M)
    return Evidence(move.goal.shown, REACHED, told(move.ended))


@check(points=2.0, depends_on=["succeeds"], deadline_s=30.0, proves=["reaches", "final_position", "position"])
def arrives(context: CheckContext) -> Evidence:
    """The robot is at the target when the goal has succeeded."""
    return by_the_last_move(context, _require_arrived, SHORTEST_M)


@check(points=1.0, depends_on=["arrives"], deadline_s=30.0, proves=["distance_travelled"])
def distance(context: CheckContext) -> Evidence:
    """The distance travelled is the length of this move."""
    target = telling_target(here(context), LONGEST_M, driven(context), context.random)
    return _require_distance(context, drive(context, target))


@check(points=1.0, depends_on=["arrives"], deadline_s=30.0, proves=["any_z"])
def any_z(context: CheckContext) -> Evidence:
    """The z of a target is ignored, whether it is 2.5 or NaN."""
    for z in (2.5, math.nan):
        move = drive_on(context, _SHORT_M, z)
        evidence = _require_arrived(move)
        require_no_z(move, z)
    return evidence


@check(points=1.0, depends_on=["arrives"], deadline_s=30.0, proves=["already_there", "progress_limits"])
def already_there(context: CheckContext) -> Evidence:
    """A goal at the present position succeeds at once."""
    place = here(context)
    goal = set_off(context, place)
    try:
        ended = arrive(context, goal, 0.0, within_s=_AT_ONCE_S)
    except Failed:
        context.spoil()
        raise
    require_progress_limits(goal)
    return _require_arrived(Move(place, place, goal, ended))


@check(points=2.0, depends_on=["arrives"], deadline_s=30.0, proves=["five_a_metre", "spread", "straight"])
def feedback(context: CheckContext) -> Evidence:
    """While the robot moves, at least five feedback messages a metre tell where it is."""
    return fairly(context, feedback_of_a_move)


@check(
    points=1.5,
    depends_on=["feedback"],
    deadline_s=30.0,
    proves=["straight", "position", "progress_limits", "monotonic", "distance_remaining"],
)
def progress(context: CheckContext) -> Evidence:
    """Progress grows, the distance left shrinks, the position is on the straight line."""
    return fairly(context, progress_of_a_move)


@check(points=1.5, depends_on=["arrives"], deadline_s=60.0, proves=["second_goal", "same_instant"])
def second_goal(context: CheckContext) -> Evidence:
    """A second goal is rejected while one runs, also when both are sent in the same instant."""
    fairly(context, second_goal_of_two)
    return fairly(context, two_at_once)


@check(
    points=2.0,
    depends_on=["arrives"],
    deadline_s=60.0,
    proves=["cancel_accepted", "cancelled", "one_thread", "position"],
)
def cancel(context: CheckContext) -> Evidence:
    """A goal is cancelled mid-way: within 1 s, short of the target."""
    return fairly(context, cancel_midway)


@check(points=1.0, depends_on=["cancel"], deadline_s=60.0, proves=["after_cancel", "cancel_accepted"])
def after_cancel(context: CheckContext) -> Evidence:
    """After a cancelled goal the next one works, starts where the robot stopped, and can be cancelled as well."""
    move = drive_on(context, SHORTEST_M)
    _require_arrived(move)
    evidence = _require_distance(context, move)
    fairly(context, cancel_midway)
    return evidence


@check(points=1.5, depends_on=["accepted"], deadline_s=60.0, proves=["edges_inside", "outside"])
def outside(context: CheckContext) -> Evidence:
    """Goals outside the arena are rejected, goals on its edges are not."""
    inside = context.random.uniform(1.0, 9.0)
    beyond = (-_EDGE_M, ARENA + _EDGE_M, context.random.uniform(20.0, 1000.0), -context.random.uniform(1.0, 50.0))
    targets = [MovePlace(value, inside) for value in beyond] + [MovePlace(inside, value) for value in beyond]
    evidence = _rejects(context, targets, f"which lies outside the arena (0 to {ARENA:g} m)")
    _require_edges(context)
    return evidence


CHECKS: tuple[Check, ...] = (
    accepted,
    succeeds,
    arrives,
    distance,
    any_z,
    already_there,
    feedback,
    progress,
    second_goal,
    cancel,
    after_cancel,
    outside,
)


def _require_arrived(move: Move) -> Evidence:
    final = place_of(move.ended.result.final_position)
    expected = f"{REACHED}, final_position within {TOLERANCE} m of {move.target}"
    evidence = Evidence(move.goal.shown, expected, told(move.ended))
    if not misses(final, move.target):
        return evidence
    if is_blank(move.ended.result):
        raise Failed(evidence, "The result is as ROS 2 creates it: your callback filled in none of its fields.")
    off = math.dist(final, move.target)
    raise Failed(evidence, f"The robot ended {off:.3g} m away from the target.", "action.stops_short")


def _require_distance(context: CheckContext, move: Move) -> Evidence:
    travelled = move.ended.result.distance_travelled
    tolerance = max(TOLERANCE, 0.05 * move.length)
    expected = f"distance_travelled within {tolerance:.3g} m of {move.length:.3g} m, the way from {move.begin}"
    evidence = Evidence(move.goal.shown, expected, told(move.ended))
    if abs(travelled - move.length) <= tolerance:
        return evidence
    since_start = abs(travelled - driven(context)) <= tolerance
    if abs(travelled - math.dist(ORIGIN, move.target)) <= tolerance and not since_start:
        message = f"That is the distance from {ORIGIN}, but the robot was at {move.begin} when this goal arrived."
    elif travelled > move.length:
        message = f"That is more than this move{': it is the sum of all moves so far' if since_start else ''}."
    elif travelled == 0.0:
        message = "The field was not filled in."
    else:
        message = "That is less than the straight line to the target."
    raise Failed(evidence, message)


def _look_at_the_nearest_edges(context: CheckContext) -> None:
    """Drive to the corner where the robot has started, while it is near, and remember for `outside` if that worked."""
    if context.job.mode == "attach":
        return
    begin, goal = _from_here(context, ORIGIN)
    if goal.accepted:
        arrive(context, goal, math.dist(begin, ORIGIN))
        context.memory[_CORNER] = ORIGIN


def _require_edges(context: CheckContext) -> None:
    """Two opposite corners, which lie on all four edges, are accepted.

    The second one is not waited for: nothing more is asked of this program.
    """
    if context.job.mode != "attach" and at_own_speed(context):
        context.spoil()  # one that has just been started is fast, and stands in a corner
    first: MovePlace | None = None if context.spoiled else context.memory.get(_CORNER)
    if first is None:
        first = nearest_corner(here(context))
        begin, goal = _sent_to_an_edge(context, first)
        try:
            arrive(context, goal, math.dist(begin, first), _AT_ONCE_S if begin == first else None)
        except Failed:  # another check's matter
            context.spoil()
    begin, goal = _sent_to_an_edge(context, opposite(first))
    if context.job.mode == "attach":
        arrive(context, goal, math.dist(begin, opposite(first)))
    else:
        context.spoil()


def _sent_to_an_edge(context: CheckContext, target: MovePlace) -> tuple[MovePlace, CheckedGoal]:
    """Where the robot is, and a goal that was accepted."""
    begin, goal = _from_here(context, target)
    if not goal.accepted and context.job.mode != "attach":
        context.spoil()  # it may be the goals before that it minds, which are another check's matter
        begin, goal = _from_here(context, target)
    if not goal.accepted:
        message = "This target lies on an edge of the arena, and the edges belong to it."
        raise Failed(Evidence(goal.shown, "the goal accepted", "the goal rejected"), message, _TOO_STRICT)
    return begin, goal


def _from_here(context: CheckContext, target: MovePlace) -> tuple[MovePlace, CheckedGoal]:
    """Where the robot is, and a goal that was answered."""
    begin = here(context)
    goal = send(context, target)
    goal.wait_for_answer("the goal accepted")
    return begin, goal


def _rejects(context: CheckContext, targets: Sequence[MovePlace], why: str) -> Evidence:
    expected = "the goal rejected"
    for target in targets:
        goal = send(context, target)
        goal.wait_for_answer(expected)
        if goal.accepted:
            context.spoil()
            message = f"Your server accepted this goal, {why}."
            raise Failed(Evidence(goal.shown, expected, "the goal accepted"), message, "action.accepts_impossible")
    return Evidence(goal.shown, expected, expected)

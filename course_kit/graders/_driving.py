"""Driving the robot of exercise 2: one goal from sending to arrival, at one of two speeds."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_interfaces.action import MoveRobot
from geometry_msgs.msg import Point

from course_kit.graders._moves import ARENA, ORIGIN, TOLERANCE, MovePlace, in_the_arena, place_of, target_from
from course_kit.grading.checks.actions import WantedAction
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.discovery import ensure_ready, start_again
from course_kit.grading.checks.goals import SUCCEEDED, CheckedGoal, Ended

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.checks.context import CheckContext

ACTION = WantedAction("/move_robot", MoveRobot)
SHORTEST_M, LONGEST_M = 1.2, 1.8  # metres; moves that are long enough for the rules about feedback
_SCALE = "COURSE_KIT_TIME_SCALE"
FAST, OWN_SPEED = {_SCALE: "0.1"}, {_SCALE: "1"}
REACHED = "SUCCEEDED"
_PLACE, _DRIVEN, _MOVED, _SLOW = "place", "driven", "moved", "own speed"  # remembered of the running submission
_BLIND = 0.3  # of the time of a trial, without which the grader cannot judge when something was sent
_SLOWEST, _EXTRA_S = 3.0, 2.0  # a move may take 3 s a metre, and 2 s more
_NO_RESPONSE = "did not return a GoalResponse type"  # rclpy's warning


class HastyError(Failed):
    """A fault that might not show with the robot at its own speed: a timer of the learner's keeps real time."""


@dataclass(frozen=True)
class Move:
    """A move that has ended SUCCEEDED."""

    begin: MovePlace
    target: MovePlace
    goal: CheckedGoal
    ended: Ended

    @property
    def length(self) -> float:
        """The straight way, in metres."""
        return math.dist(self.begin, self.target)


def at_own_speed(context: CheckContext) -> bool:
    """Whether the robot that runs now drives at 1 m/s."""
    return context.job.mode == "attach" or _SLOW in context.memory


def fairly(context: CheckContext, trial: Callable[[CheckContext], Evidence]) -> Evidence:
    """Run a trial with the fast robot; if that may have been the reason of a failure, again at its own speed.

    Once more where others kept the grader from its work meanwhile: what it sees late looks as if it was sent late. A
    program that was started for its own speed stays: what follows is then slow for it, and as fair.
    """
    again = True
    while True:
        clock = context.clock()
        try:
            return trial(context)
        except HastyError:
            if at_own_speed(context) and not (again and clock.grader_lost() > _BLIND * clock.wall()):
                context.spoil()
                raise
            again = not at_own_speed(context)
        except Failed:
            context.spoil()
            raise
        _slow_down(context)


def _slow_down(context: CheckContext) -> None:
    """Start the program again, with the robot at its own speed; a node that we have not started drives so already."""
    if context.job.mode != "attach":
        start_again(context, ACTION, OWN_SPEED)
        context.memory[_SLOW] = True
    context.record.clear()  # the verdict is on this trial alone


def here(context: CheckContext) -> MovePlace:
    """Where the robot is. A node that we have not started may have driven before: that one is sent somewhere first."""
    ensure_ready(context, ACTION)
    if _PLACE not in context.memory:
        if context.job.mode != "attach":
            return ORIGIN
        arrive(context, set_off(context, MovePlace(ARENA / 2, ARENA / 2)), longest_way(context))
    place: MovePlace = context.memory[_PLACE]
    return place


def longest_way(context: CheckContext, target: MovePlace | None = None) -> float:
    """How long a first move may be, in metres: the way from (0, 0), but any way of a robot that has driven before."""
    if target is None or context.job.mode == "attach":
        return math.hypot(ARENA, ARENA)
    return math.dist(ORIGIN, target)


def driven(context: CheckContext) -> float:
    """The ways of all moves so far together, in metres."""
    return float(context.memory.get(_DRIVEN, 0.0))


def is_at(context: CheckContext, place: MovePlace) -> None:
    """Remember where the robot is now, as its program says; whether that is true is for the checks to tell."""
    context.memory[_PLACE] = in_the_arena(place)


def send(context: CheckContext, target: MovePlace, z: float = 0.0) -> CheckedGoal:
    """Send a goal.

    Args:
        context: the check's.
        target: x and y, in metres.
        z: in metres; it does not matter.
    """
    shown = f"a goal with target=({target.x:.4g}, {target.y:.4g}, {z:.4g})"
    return CheckedGoal(context, ACTION, MoveRobot.Goal(target=Point(x=target.x, y=target.y, z=z)), shown)


def set_off(context: CheckContext, target: MovePlace, z: float = 0.0) -> CheckedGoal:
    """Send a reachable goal and have it accepted.

    Args:
        context: the check's.
        target: x and y, in metres.
        z: in metres; it does not matter.

    Raises:
        Failed: it was not.
    """
    goal = send(context, target, z)
    goal.wait_for_answer("the goal accepted")
    if not goal.accepted:
        raise _rejected(context, goal, target, z)
    return goal


def drive(context: CheckContext, target: MovePlace, z: float = 0.0) -> Move:
    """Drive the robot to a target.

    Args:
        context: the check's.
        target: x and y, in metres.
        z: in metres; it does not matter.

    Raises:
        Failed: the goal was not accepted, or ended otherwise than SUCCEEDED.
    """
    begin = here(context)
    try:
        goal = set_off(context, target, z)
        move = Move(begin, target, goal, arrive(context, goal, math.dist(begin, target)))
    except Failed:
        context.spoil()
        raise
    if move.length > SHORTEST_M - TOLERANCE:
        context.memory[_MOVED] = move
    return move


def drive_on(context: CheckContext, length: float, z: float = 0.0) -> Move:
    """Drive the robot so many metres, anywhere; as `drive`.

    Args:
        context: the check's.
        length: in metres.
        z: in metres; it does not matter.
    """
    return drive(context, target_from(here(context), length, context.random), z)


def by_the_last_move(context: CheckContext, judge: Callable[[Move], Evidence], length: float) -> Evidence:
    """Judge the last long move, or, if that one is not right, one that is made for it.

    A right robot need not drive again for each thing that is asked of a move; what is wrong is shown by a move of the
    check's own.

    Args:
        context: the check's.
        judge: raises Failed for a move that is not right.
        length: of the check's own move, in metres.
    """
    last: Move | None = None if context.spoiled else context.memory.get(_MOVED)
    if last is not None and last.length > length - TOLERANCE:
        with suppress(Failed):
            return judge(last)
    return judge(drive_on(context, length))


def arrive(context: CheckContext, goal: CheckedGoal, length: float, within_s: float | None = None) -> Ended:
    """Wait until an accepted goal has ended, SUCCEEDED, and remember where the robot is.

    Args:
        context: the context of the check.
        goal: the goal.
        length: of the way, in metres.
        within_s: the patience in seconds, None for what the length allows.

    Raises:
        Failed: it has not, or otherwise.
    """
    ended = goal.wait_for_end(allowed_s(length) if within_s is None else within_s, REACHED)
    goal.require_status(ended, SUCCEEDED, Evidence(goal.shown, REACHED, told(ended)))
    is_at(context, place_of(ended.result.final_position))
    context.memory[_DRIVEN] = driven(context) + length
    return ended


def allowed_s(length: float) -> float:
    """How long a move may take, in seconds, by its length in metres."""
    return _SLOWEST * length + _EXTRA_S


def told(ended: Ended) -> str:
    """The end of a goal as the learner is shown it."""
    result = ended.result
    return (
        f"{ended.name}, final_position=({result.final_position.x:.4g}, {result.final_position.y:.4g}), "
        f"distance_travelled={result.distance_travelled:.4g}"
    )


def is_blank(result: MoveRobot.Result) -> bool:
    """Whether a result is as ROS 2 makes it: nobody has filled in anything."""
    return bool(result == MoveRobot.Result())


def misses(place: MovePlace, target: MovePlace) -> bool:
    """Whether a place is not the target, within the tolerance; NaN misses."""
    return not math.dist(place, target) <= TOLERANCE


def reject_all_or_some(context: CheckContext, goal: CheckedGoal, others: list[MovePlace]) -> Failed:
    """A first goal was rejected: are all, or is it just this one?

    Args:
        context: the check's.
        goal: the one that was rejected.
        others: targets to try.
    """
    evidence = Evidence(goal.shown, "the goal accepted", "the goal rejected")
    process = goal.process()
    for other in others:
        again = send(context, other)
        again.wait_for_answer("the goal accepted")
        if again.accepted:
            context.spoil()
            return Failed(
                evidence,
                f"This target lies in the arena, and so does {other}, which your server accepted.",
                "validation.overzealous",
            )
    message = f"Each of {len(others) + 1} goals in the arena was rejected."
    if _NO_RESPONSE in process.stderr:
        message += " Your goal callback did not return a GoalResponse; rclpy takes that as a rejection."
    return Failed(evidence, message, "action.rejects_all")


def _rejected(context: CheckContext, goal: CheckedGoal, target: MovePlace, z: float) -> Failed:
    """A good goal was rejected by a server that has accepted others: for what it is, or for what was before?"""
    evidence = Evidence(goal.shown, "the goal accepted", "the goal rejected")
    context.spoil()
    if context.job.mode != "attach":
        fresh = send(context, target, z)
        fresh.wait_for_answer("the goal accepted")
        context.spoil()
        if fresh.accepted:
            message = (
                "No goal was running any more, and after a fresh start your node accepts this same goal: "
                "it never clears its mark that a goal is running."
            )
            return Failed(evidence, message)
    message = "This goal can be reached: it lies in the arena, whose edges count as inside, and z does not matter."
    return Failed(evidence, message, "validation.overzealous")

"""Exercise 2: places in the arena, and what a client can see of a move: its feedback and its end."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from course_interfaces.action import MoveRobot

from course_kit.grading.checks.evidence import UnseenError
from course_kit.grading.checks.graded_goal import ABORTED, CANCELED, PROMPT_S, SUCCEEDED, describe_end
from course_kit.grading.checks.vocabulary import Evidence, Failed, draw_between, draw_by, draw_one_of

if TYPE_CHECKING:
    import random
    from collections.abc import Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.graded_goal import GradedGoal
    from course_kit.grading.checks.grader_node import ReceivedFeedback
    from course_kit.grading.checks.vocabulary import GradedNode
    from course_kit.ros.messages import Message

ARENA = 10.0  # metres; 0 <= x, y <= ARENA
TOLERANCE = 0.05  # metres; how near to the target a move has to end
BESIDE = 0.1  # metres; how far from the straight way a position may lie
LONG_M = 1.0  # from this length on feedback has to come
_A_METRE = 5  # feedback messages
_BARELY_BEGUN = 0.1  # the progress that the first message says at most
_FITS = 0.05  # how well progress fits distance_remaining
_ROUNDING = 1e-6
_QUARTER = math.pi / 2.0
_NO_RESPONSE = "did not return a GoalResponse type"  # rclpy's warning
A_SECOND = 1.2  # and what the grader sees late; in metres, how far the robot goes on after cancelling was accepted
FAR_M = 2.4  # to be cancelled on at its own speed, as an answer may take a second; farther edges are not driven to
CANCEL_UNTIL_M = 0.3  # before the target; until then it has to work
SHORT_M = CANCEL_UNTIL_M + 0.15  # to be cancelled on the way, as a request takes its time; shorter ways are driven
_NEAR_M = 0.5  # metres; a robot that reports five times a metre was seen so near to where it went
OVERLAP_S = 0.01  # for which two goals may seem to run together, by the order in which their statuses come
OFTEN = 3  # times that the fast robot was too fast, after which the own speed stays, or that something was over unseen


class HastyError(Failed):
    """A fault that might not show with the robot at its own speed: a learner's own clock keeps real time."""


class ArenaPoint(NamedTuple):
    """A place in the arena, in metres."""

    x: float
    y: float

    def __str__(self) -> str:
        return f"({self.x:.2f}, {self.y:.2f})"


ORIGIN, CENTRE = ArenaPoint(0.0, 0.0), ArenaPoint(ARENA / 2, ARENA / 2)


@dataclass
class Speed:
    """Kept with the conversation: whether the robot that runs now drives at 1 m/s, and how often that was needed."""

    own: bool
    needed: int
    accepted: bool = False  # a goal was, ever
    succeeded: bool = False


@dataclass(frozen=True)
class Way:
    """A drawn move, relative to where the robot is."""

    length: float
    angle: float


@dataclass(frozen=True)
class Move:
    """A move that has ended."""

    begin: ArenaPoint
    target: ArenaPoint
    goal: GradedGoal
    ended: Message  # the response to the request for its result
    may_remain: float = TOLERANCE  # metres, at the end; more where arriving is lost already

    @property
    def length(self) -> float:
        """The straight way, in metres."""
        return math.dist(self.begin, self.target)


def draw_way(*lengths: Any) -> Any:
    """A drawing of a way that has one of these drawn lengths, along a wall or in any direction."""

    def make(rng: random.Random) -> Way:
        turns = rng.choice((rng.uniform(0.0, 4.0), float(rng.randrange(4))))
        return Way(rng.choice(lengths).make(rng), turns * _QUARTER)

    return draw_by(make)


# --- what is drawn

CORNER = ArenaPoint(ARENA, ARENA)
ANGLE, Z = draw_between(0.0, 2.0 * math.pi), draw_one_of(0.0, 0.0, -1.0, 2.5, math.nan)
_OUTSIDE = tuple(place for off in (-0.001, ARENA + 0.001, ARENA + 500.0, -20.0) for place in ((off, 5.0), (5.0, off)))
_NO_PLACES = tuple(place for value in (math.nan, math.inf, -math.inf) for place in ((value, 5.0), (5.0, value)))
OUTSIDE = draw_by(lambda rng: rng.sample(_OUTSIDE, len(_OUTSIDE)))
NO_PLACES = draw_by(lambda rng: rng.sample(_NO_PLACES, len(_NO_PLACES)))
SHORT_MOVES = draw_one_of(*[draw_way(draw_between(*ends)) for ends in ((0.01, 0.04), (0.06, 0.12), (0.12, 0.9))])
LONG_MOVES = draw_way(draw_between(1.0, 1.8))
MOVES = draw_way(draw_between(1.0, 1.3), draw_between(1.0, 1.8), draw_between(0.06, 0.2), draw_between(0.2, 0.9))
THEN = draw_one_of(None, MOVES)
STOPS = draw_way(draw_between(1.7, 2.1))
CUTS = draw_one_of(0.0, 0.02, 0.1, 0.35, 0.5, 1.0)  # shares; 1.0: almost too late
_KINDS = ("second", "outside", "same", "nowhere", "second", "outside")
MOMENTS = draw_one_of(*zip((0.0, 0.1, 0.5, 0.5, 0.7, 0.7), _KINDS, strict=True))  # shares of the way, and what comes


def allowed_s(length: float) -> float:
    """How long a move may take: 3 s for each metre, and 2 s in addition."""
    return 3.0 * length + 2.0


def speed_of(context: CheckContext) -> Speed:
    """At which speed the robot drives in this conversation; a stranger's always at its own."""
    strange = context.job.mode == "attach"
    speed: Speed = context.conversations.setdefault(Speed, Speed(strange, OFTEN if strange else 0))
    return speed


def place_of(point: Any) -> ArenaPoint:
    """The place of a geometry_msgs/Point."""
    return ArenaPoint(point.x, point.y)


def place_inside(here: ArenaPoint, length: float, angle: float, margin: float = 0.0) -> ArenaPoint:
    """The place in the arena so far away, in this direction or the next one inside; along x, y stays the same."""
    for turn in range(40):
        turned = angle + turn * _QUARTER + turn // 4 * 0.16
        place = ArenaPoint(here.x + round(length * math.cos(turned), 9), here.y + round(length * math.sin(turned), 9))
        if all(margin < value < ARENA - margin for value in place):  # the edges are another check's
            return place
    return CENTRE


def distance_beside(begin: ArenaPoint, end: ArenaPoint, place: ArenaPoint) -> float:
    """How far a place lies from the straight way between two others, in metres; NaN for a place that is none."""
    way = math.dist(begin, end) or 1.0  # without a way there is only its beginning
    along = ((place.x - begin.x) * (end.x - begin.x) + (place.y - begin.y) * (end.y - begin.y)) / way**2
    along = min(max(along, 0.0), 1.0)
    return math.dist(place, (begin.x + along * (end.x - begin.x), begin.y + along * (end.y - begin.y)))


def metres_left(goal: GradedGoal, target: ArenaPoint, at_s: float = math.inf) -> float:
    """How far from its target the robot was at the last feedback so far, or until then; endless without feedback."""
    heard = [message.feedback for message in goal.feedback if message.came_s <= at_s]
    return math.dist(place_of(heard[-1].position), target) if heard else math.inf


# --- a goal and its answer


def send_goal(node: GradedNode, target: ArenaPoint, z: float = 0.0) -> GradedGoal:
    """Send a goal."""
    goal = node.goal("/move_robot", target={"x": target.x, "y": target.y, "z": z})
    goal.shown = f"a goal with target=({target.x:.6g}, {target.y:.6g}, {z:.6g})"
    return goal


def explain_rejection(node: GradedNode, goal: GradedGoal, target: ArenaPoint, z: float, breaks: str) -> Failed:
    """A valid goal was rejected: find out what the server minds: this goal, all goals, or what was before."""
    evidence, stderr = Evidence(goal.shown, "the goal accepted", "the goal rejected"), goal.process().stderr
    starts = node.context.job.mode != "attach"
    speed_of(node.context).accepted |= (takes_centre := _accepts(node, CENTRE))
    if not takes_centre and starts:
        if _accepts(node, target, z, afresh=True):
            why = (
                "No goal was running, but your node rejected this goal. After a fresh start it accepts the same goal. "
                "So it still believes that an earlier goal is running."
            )
            return Failed(evidence, why, breaks="succeeds")
        if not _accepts(node, CENTRE, afresh=True):
            why = f"This goal was rejected, and one to {CENTRE} as well."
            if _NO_RESPONSE in stderr:
                why += " Your goal callback did not return a GoalResponse; rclpy takes that as a rejection."
            return Failed(evidence, why, "action.rejects_all", breaks="accepted")
    inside = ArenaPoint(*(min(max(value, BESIDE), ARENA - BESIDE) for value in target))
    if starts and inside != target and not _accepts(node, inside, afresh=True):
        breaks = "accepted"  # it is not the edge that the server minds
    why = f"One to {CENTRE} is accepted. This one lies in the arena, too: its edges belong to it, and z is ignored."
    return Failed(evidence, why, "validation.overzealous", breaks=breaks or "accepted")


def _accepts(node: GradedNode, target: ArenaPoint, z: float = 0.0, *, afresh: bool = False) -> bool:
    """Whether the program accepts a goal, as it is or after a fresh start."""
    with node.context.record.looking_away():
        if afresh:
            node.context.spoil()
        return send_goal(node, target, z).wait_for_answer("the goal accepted")


def require_one_at_a_time(
    context: CheckContext, first: GradedGoal, second: GradedGoal, evidence: Evidence
) -> GradedGoal:
    """Of two goals that were both accepted none ran with the other, by the server's own statuses; the later one."""
    context.wait_until(lambda: bool(first.began_at and second.began_at), PROMPT_S)
    later = max(first, second, key=lambda goal: goal.began_at)
    if any(goal.over_at is not None and goal.over_at <= later.began_at for goal in (first, second)):
        return later
    if context.wait_until(lambda: first.over_at is not None, PROMPT_S) and first.statuses[-1][1] in (ABORTED, CANCELED):
        why = "Your server ended the first goal when the second arrived. It has to reject the second instead."
        raise Failed(evidence, why, breaks="second_goal")
    both = bool(second.feedback) and second.feedback[0].came_s < (first.over_at or math.inf)
    why = "Your server accepted a second goal while the first was still running."
    raise Failed(evidence, why, "action.concurrent_goals" if both else None, breaks="second_goal")


# --- one aspect of a move


def require_arrival(move: Move) -> None:
    """The result says that the robot is at the target."""
    off = math.dist(place_of(move.ended.result.final_position), move.target)
    if off <= TOLERANCE:
        return
    expected = f"SUCCEEDED, final_position within {TOLERANCE} m of {move.target}"
    evidence = Evidence(move.goal.shown, expected, describe_end(move.ended))
    if move.ended.result == MoveRobot.Result():
        raise Failed(evidence, "The result still has its default values: your callback set none of its fields.")
    raise Failed(evidence, f"The robot ended {off:.3g} m away from the target.", "action.stops_short")


def require_distance(move: Move) -> None:
    """The result says how long the way was."""
    travelled, arrived = move.ended.result.distance_travelled, move.ended.status == SUCCEEDED
    end = move.target if arrived else place_of(move.ended.result.final_position)
    length = math.dist(move.begin, end)
    tolerance = max(TOLERANCE, 0.05 * length) + min(move.may_remain, SHORT_M) - TOLERANCE
    if abs(travelled - length) <= tolerance:
        return
    expected = f"distance_travelled within {tolerance:.3g} m of {length:.3g} m, the way from {move.begin}"
    evidence = Evidence(move.goal.shown, expected, describe_end(move.ended))
    began = place_of(move.goal.feedback[0].feedback.position) if move.goal.feedback else move.begin
    why = "distance_travelled is not the length of this move alone."
    if math.dist(began, move.begin) > TOLERANCE and abs(travelled - math.dist(began, end)) <= tolerance:
        why = f"This move began at {began}, although the result before it said that the robot was at {move.begin}."
    elif abs(travelled - math.dist(ORIGIN, end)) <= tolerance:
        why = f"distance_travelled is as long as the way from {ORIGIN}, but this goal's way began at {move.begin}."
    elif not arrived and abs(travelled - move.length) <= tolerance:
        why = "distance_travelled is the whole distance to the target, but the robot has stopped before."
    elif not arrived and math.dist(end, move.target) <= TOLERANCE:
        why = "final_position is the target, but distance_travelled says that the robot stopped before."
    raise Failed(evidence, why)


def require_enough(move: Move) -> None:
    """A move of 1 m or more comes with enough feedback, all along."""
    if move.length < LONG_M:
        return
    enough = math.floor(_A_METRE * move.length + _ROUNDING)
    expected = f"at least {enough} feedback messages, spread over the move of {move.length:.3g} m"
    try:
        move.goal.require_feedback(enough, expected, part_left=lambda said: said.distance_remaining / move.length)
    except Failed as failed:
        raise HastyError(failed.evidence, failed.message, failed.diagnosis) from None


def require_truth(move: Move) -> None:
    """What feedback says of a move is true; feedback of a long one that has arrived covers all of it."""
    long = move.length >= LONG_M
    whole = long and move.ended.status == SUCCEEDED
    heard = move.goal.wait_for_last_feedback(
        lambda messages: not whole or bool(messages and messages[-1].feedback.distance_remaining <= move.may_remain)
    )
    expected = f"progress 0 to 1, distance_remaining down to 0, positions on the line {move.begin} to {move.target}"
    if not heard:  # another check's matter
        return
    if found := find_jump(heard):
        evidence = Evidence(move.goal.shown, expected, found)
        why = f"Two messages of one move contradict each other: {found}." if "then" in found else f"It was {found}."
        raise Failed(evidence, why, "action.feedback_not_monotonic")
    for state in heard:
        _require_on_the_way(move, state.feedback)
    if whole:
        _require_from_begin_to_end(move, heard, expected)
    for said in [state.feedback for state in heard] if long else ():
        wanted = 1.0 - said.distance_remaining / move.length
        if not abs(said.progress - wanted) <= _FITS + _ROUNDING:
            got = f"progress={said.progress:.4g} with distance_remaining={said.distance_remaining:.4g}"
            expected = f"progress within {_FITS} of {wanted:.3g}: {move.length:.3g} m is this goal's whole distance"
            why = f"progress={said.progress:.4g} is not the part of this goal's own way that is done."
            raise HastyError(Evidence(move.goal.shown, expected, got), why)


def require_no_jump(goal: GradedGoal, lost: frozenset[str]) -> None:
    """Nor does a goal without a way say anything else than that it is done."""
    if "progress" not in lost and (found := find_jump(goal.feedback)):
        evidence = Evidence(goal.shown, "progress from 0 to 1, if any", found)
        raise Failed(evidence, "Nothing is left to drive, but progress goes from 0 to 1.", breaks="already_there")


def find_jump(feedback: Sequence[ReceivedFeedback]) -> str:
    """The first two messages between which progress falls or the distance left grows; empty when there are none."""
    values = [message.feedback for message in feedback]
    for value in values:
        if not -_ROUNDING <= value.progress <= 1.0 + _ROUNDING:
            return f"progress={value.progress!r}, which is not between 0 and 1"
    for before, after in itertools.pairwise(values):
        if not after.progress >= before.progress - _ROUNDING:
            return f"progress={before.progress:.7g}, then {after.progress:.7g}"
        if not after.distance_remaining <= before.distance_remaining + _ROUNDING:
            return f"distance_remaining={before.distance_remaining:.8g}, then {after.distance_remaining:.8g}"
    return ""


def _require_on_the_way(move: Move, feedback: Any) -> None:
    place = place_of(feedback.position)
    off = distance_beside(move.begin, move.target, place)
    filled_in = any(place_of(message.feedback.position) != ORIGIN for message in move.goal.feedback)
    blank = "" if filled_in else " Was feedback.position filled in?"
    if not off <= BESIDE:
        evidence = Evidence(move.goal.shown, f"positions within {BESIDE} m of the straight line", f"{place}")
        raise Failed(evidence, f"This position lies {off:.2g} m away from the straight line to the target.{blank}")
    left = math.dist(place, move.target)
    if not abs(feedback.distance_remaining - left) <= BESIDE:
        wanted = f"distance_remaining within {BESIDE} m of {left:.3g} m, the way from {place}"
        evidence = Evidence(move.goal.shown, wanted, f"distance_remaining={feedback.distance_remaining:.4g}")
        # The robot may have moved between the two; at its own speed not that far.
        why = "distance_remaining is not the distance from the position in the same message to the target."
        raise HastyError(evidence, f"{why}{blank}")


def _require_from_begin_to_end(move: Move, heard: Sequence[ReceivedFeedback], expected: str) -> None:
    first, last = heard[0].feedback, heard[-1].feedback
    got = f"{len(heard)} messages, progress={first.progress:.4g} to {last.progress:.4g}"
    evidence = Evidence(move.goal.shown, f"{expected}; progress at most {_BARELY_BEGUN} at first", got)
    if not last.distance_remaining <= move.may_remain:
        why = f"The last feedback said progress={last.progress:.4g}: publish one more when the robot arrives."
        raise HastyError(evidence, why)
    begun = 1.0 - math.dist(place_of(first.position), move.target) / move.length
    if min(first.progress, begun) > _BARELY_BEGUN + _ROUNDING:
        why = f"The first feedback said progress={first.progress:.4g}: publish one before a tenth of the way is done."
        raise HastyError(evidence, why)


ASPECTS = {  # of a move that has ended SUCCEEDED, by the check whose points it costs
    "arrives": require_arrival,
    "distance": require_distance,
    "feedback": require_enough,
    "progress": require_truth,
}

# --- a move that is cancelled


def explain_refusal(failed: Failed, goal: GradedGoal, target: ArenaPoint, waited_s: float, *, slow: bool) -> Failed:
    """Whether cancelling was really refused, or the robot may have arrived before."""
    left, code = metres_left(goal, target), failed.diagnosis
    if code == "service.blocks":
        failed.diagnosis = "action.cancel_blocked"
        return failed
    if code == "action.cancel_refused" and left > CANCEL_UNTIL_M and (slow or goal.feedback):
        return failed
    if slow and not (code == "action.cancel_blocked" and waited_s > PROMPT_S):
        return UnseenError(failed.evidence, failed.message, breaks=failed.breaks)
    return HastyError(failed.evidence, failed.message, code, breaks=failed.breaks)


def require_stop(move: Move, breaks: str, took_s: float, *, short: bool) -> None:
    """A goal whose cancelling was accepted ended CANCELED where the robot can have stopped."""
    goal, ended, target = move.goal, move.ended, move.target
    evidence = Evidence(goal.shown, "CANCELED, where the robot was then, before the target", describe_end(ended))
    places = (place_of(message.feedback.position) for message in reversed(goal.feedback))
    # Where it was last on its way; what lies beside it is another check's matter.
    seen = next((place for place in places if distance_beside(move.begin, target, place) <= BESIDE), None)
    stopped = place_of(ended.result.final_position)
    if math.dist(stopped, target) <= TOLERANCE and ended.status in (SUCCEEDED, CANCELED):
        if ended.status == CANCELED if seen is None else math.dist(seen, target) > _NEAR_M:
            where = "it was cancelled at once" if seen is None else f"the last feedback said that it was at {seen}"
            raise HastyError(evidence, f"The result says that the robot is at the target, but {where}.", breaks=breaks)
        if short:
            why = "Your server agreed to cancel the goal, but the robot drove on to its target."
            raise HastyError(evidence, why, "action.cancel_ignored", breaks=breaks)
        return
    goal.require_status(ended, CANCELED, evidence, breaks)
    moved = seen is not None and math.dist(move.begin, seen) > BESIDE
    if ended.result == MoveRobot.Result() and (moved or math.dist(move.begin, ORIGIN) > BESIDE):  # else it may be so
        why = "The result still has its default values: your callback set none of its fields when it was cancelled."
        raise Failed(evidence, why, breaks=breaks)
    if took_s > A_SECOND:
        evidence = replace(evidence, got=f"CANCELED after {took_s:.1f} s")
        why = f"The goal ended {took_s:.1f} s after your server agreed to cancel it."
        raise HastyError(evidence, why, breaks=breaks)
    if not distance_beside(move.begin, target, stopped) <= BESIDE:
        why = f"That place is not on the way from {move.begin} to {target}."
        raise Failed(evidence, why, breaks="progress")
    if seen is not None and math.dist(move.begin, stopped) < math.dist(move.begin, seen) - BESIDE:
        why = f"The last feedback said {seen}, but the result says {stopped}: the robot cannot have driven back."
        raise Failed(evidence, why, breaks="progress")

"""Exercise 2: the action /move_robot, which drives a simulated robot, in a conversation with a model.

The model knows where the robot is. The robot is made fast by COURSE_KIT_TIME_SCALE; what a
learner's own clock, or a busy machine, might have spoiled is done again at the robot's own speed before it counts.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from course_interfaces.action import MoveRobot

from course_kit.graders import _feedback
from course_kit.graders._feedback import ARENA, TOLERANCE, HastyError, Move, Place, describe_end, place_of
from course_kit.grading.checks.goals import ABORTED, CANCELED
from course_kit.grading.checks.vocabulary import (
    Evidence,
    Failed,
    GradedGoal,
    GradedNode,
    Model,
    between,
    conversation,
    drawn,
    either,
    node_name,
    offered,
    part,
    rule,
)

if TYPE_CHECKING:
    import random
    from collections.abc import Callable

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.goals import Ended

INTERFACES = (MoveRobot,)
ACTION = "/move_robot"
_SCALE = "COURSE_KIT_TIME_SCALE"
VARIABLES = {_SCALE: "0.1"}
_OWN_SPEED = {_SCALE: "1"}
_ORIGIN = Place(0.0, 0.0)
_SLOWEST_S, _EXTRA_S = 3.0, 2.0  # a move may take so long a metre, and so much more
_AT_ONCE_S = 1.0  # a goal at the present position
_LONGEST_AT_OWN_SPEED_M = 1.6
_NEAR_M = 2.5  # farther edges are not driven to: that they are accepted is enough
_PROMPT_S = 1.0  # within which the statuses of two goals have come
_OFTEN = 3  # times that the fast robot was too fast, after which the own speed stays
_LATEST_AT_OWN_SPEED = 0.5  # share of a way, after which the grader might come too late
_REFUSED_S = 0.03  # who goes on for longer after refusing to cancel was not there yet
_BLIND = 0.3  # of the time of a step, without which the grader cannot judge when something was sent
_PAIRS = 4  # of goals in the same instant: which callback comes first is a matter of chance
_NO_RESPONSE = "did not return a GoalResponse type"  # rclpy's warning
_LONG = (between(1.0, 1.5), between(1.0, 2.2))
_SHORT = (between(0.06, 0.2), between(0.2, 0.9))
_ASPECTS = ("arrives", "distance", "feedback", "progress")  # of a move, each the id of a check
_ANGLE = between(0.0, 2.0 * math.pi)
_ANY_Z = either(0.0, 0.0, -1.0, 2.5, math.nan)
_BESIDE_THE_ARENA = tuple(
    target for off in (-0.001, ARENA + 0.001, ARENA + 500.0, -20.0) for target in ((off, 5.0), (5.0, off))
)
_NO_PLACES = tuple(target for value in (math.nan, math.inf, -math.inf) for target in ((value, 5.0), (5.0, value)))


class _OverError(Failed):
    """What was to be seen was over before the grader could see it, at the robot's own speed: it shows nothing."""


@dataclass
class _Speed:
    """Kept with the conversation: whether the robot that runs now has its own speed, and how often that was needed."""

    own: bool = False
    needed: int = 0


@dataclass(frozen=True)
class _Way:
    """A drawn move, relative to where the robot is."""

    length: float
    angle: float


def _ways(*lengths: Any) -> Any:
    def make(rng: random.Random) -> _Way:
        chosen = rng.choice(lengths)
        return _Way(chosen.make(rng), rng.uniform(0.0, 2.0 * math.pi))

    return drawn(make)


class RobotModel(Model):
    """Where the robot is, and what plain moves have shown to be right."""

    def __init__(self) -> None:
        self.at = _ORIGIN
        self.before = "accepted"  # the check that is about what happened last
        self.stopped = False  # by a cancel, and has not arrived anywhere since
        self.happened: list[str] = []  # these checks, in the order of their first time
        self.right: set[str] = set()  # the aspects in which plain moves were right
        self.wrong: set[str] = set()  # those in which one was not

    def begin(self, node: GradedNode) -> None:
        """Have the robot at its own speed where the fast one was too fast; look where a stranger's robot is."""
        context = node.context
        if context.job.mode == "attach":
            goal = self.send(node, Place(ARENA / 2, ARENA / 2), 0.0)
            self.have_accepted(node, goal, Place(ARENA / 2, ARENA / 2))
            self.arrive(goal, math.hypot(ARENA, ARENA))
        elif _speed_of(context).own:
            self.start_afresh(node)

    # --- plain moves

    @rule("succeeds", way=_ways(*_LONG), often=2)
    def succeed(self, node: GradedNode, way: _Way) -> None:
        """A goal in the arena is reached."""
        self.fairly(node, lambda: self.drive(node, way))

    @rule("arrives", way=_ways(*_LONG, *_SHORT), often=2)
    def get_there(self, node: GradedNode, way: _Way) -> None:
        """The robot is where it has to be."""
        self.judged(node, way, "arrives")

    @rule("distance", way=_ways(*_LONG, *_SHORT), often=2)
    def measure(self, node: GradedNode, way: _Way) -> None:
        """The result has the way of this goal."""
        self.judged(node, way, "distance")

    @rule("any_z", way=_ways(*_LONG, *_SHORT), z=either(2.5, math.nan, -1.0))
    def ignore_z(self, node: GradedNode, way: _Way, z: float) -> None:
        """Whatever stands in z changes nothing."""

        def act() -> None:
            self.leave_the_cancelled(node)
            move = self.drive(node, way, z, check="any_z")
            try:
                self.judge_known(node, move, "any_z")
            except Failed as failed:
                if failed.breaks == "any_z":
                    failed.message, failed.diagnosis = _feedback.explain_z(move, z) or failed.message, None
                raise

        self.fairly(node, act)

    @rule("feedback", way=_ways(between(1.6, 2.2)), often=2)
    def report(self, node: GradedNode, way: _Way) -> None:
        """There is feedback all along."""
        self.judged(node, way, "feedback")

    @rule("progress", way=_ways(*_LONG, *_SHORT), often=4)
    def make_progress(self, node: GradedNode, way: _Way) -> None:
        """What feedback says is true."""
        self.judged(node, way, "progress")

    @rule("already_there", often=2)
    def be_there(self, node: GradedNode) -> None:
        """A goal at the present position succeeds at once."""

        def act() -> None:
            at_edge = any(value in (0.0, ARENA) for value in self.at)
            goal = self.send(node, self.at, 0.0)
            self.have_accepted(node, goal, self.at, breaks="outside" if at_edge else "already_there")
            ended = self.arrive(goal, 0.0, within_s=_AT_ONCE_S, breaks="already_there")
            _feedback.require_limits(goal)
            _judge("arrives", Move(self.at, self.at, goal, ended), breaks="already_there")
            self.note("already_there")

        self.fairly(node, act)

    @rule("outside", corner=either((0.0, 0.0), (ARENA, ARENA)))
    def reach_edge(self, node: GradedNode, corner: tuple[float, float]) -> None:
        """The edges belong to the arena."""

        def act() -> None:
            target = Place(*corner)
            goal = self.send(node, target, 0.0)
            self.have_accepted(node, goal, target, breaks="outside")
            length = math.dist(self.at, target)
            if length <= _NEAR_M or node.context.job.mode == "attach":
                self.arrive(goal, length)
                self.note("succeeds")
            else:
                self.start_afresh(node)

        self.fairly(node, act)

    # --- goals that have to be rejected

    @rule("outside", target=either(*_BESIDE_THE_ARENA), z=_ANY_Z)
    def send_outside(self, node: GradedNode, target: tuple[float, float], z: float) -> None:
        """A target outside the arena is rejected."""
        self.reject(node, Place(*target), z, f"this goal, which lies outside the arena (0 to {ARENA:g} m)", "outside")

    @rule("not_a_number", target=either(*_NO_PLACES), z=_ANY_Z)
    def send_nowhere(self, node: GradedNode, target: tuple[float, float], z: float) -> None:
        """A target that is no place is rejected."""
        self.reject(node, Place(*target), z, "this goal, which is not a place", "not_a_number")

    def reject(self, node: GradedNode, target: Place, z: float, what: str, check: str) -> None:
        """A goal is rejected while the robot is free."""
        goal = self.send(node, target, z)
        try:
            goal.rejected(what=what, breaks=check)
        except Failed as failed:
            node.context.spoil()
            if not goal.answered:
                failed.breaks = self.before
            raise
        self.note(check)

    @rule(
        "second_goal",
        way=_ways(between(1.2, 1.5)),
        moment=either(
            (0.0, "second"), (0.1, "outside"), (0.5, "second"), (0.5, "nowhere"), (0.85, "second"), (0.85, "outside")
        ),
        angle=_ANGLE,
    )
    def disturb(self, node: GradedNode, way: _Way, moment: tuple[float, str], angle: float) -> None:
        """A goal that comes while another one runs is rejected, and changes nothing."""
        self.fairly(node, lambda: self._disturb(node, way, moment, angle))

    def _disturb(self, node: GradedNode, way: _Way, moment: tuple[float, str], angle: float) -> None:
        share, kind = moment
        self.leave_the_cancelled(node)
        begin, target = self.at, self.target_of(node, way)
        first = self.send(node, target, 0.0)
        self.have_accepted(node, first, target)
        self.wait_for_share(node, first, begin, target, share)
        other = {"outside": Place(-0.5, 5.0), "nowhere": Place(math.nan, 5.0)}.get(kind)
        other = other or _inside(begin, 1.0, angle)
        for target_of_other, what in ((other, kind), (_inside(begin, 0.6, angle + 1.0), "second")):
            self._reject_second(node, first, target_of_other, what)
        length = math.dist(begin, target)
        ended = self.arrive(first, length, breaks="second_goal")
        self.judge_known(node, Move(begin, target, first, ended), "second_goal")
        self.note("second_goal")

    def _reject_second(self, node: GradedNode, first: GradedGoal, target: Place, kind: str) -> None:
        """A goal is rejected while another one runs."""
        second = self.send(node, target, 0.0)
        expected = "the second goal rejected while the first runs"
        second.wait_for_answer(expected, _allowed_s(math.dist(self.at, target)))
        first.shown = f"{first.shown}; under way, {second.shown}"
        if not second.accepted:
            return
        node.context.spoil()
        evidence = Evidence(first.shown, expected, "both goals accepted")
        if kind != "second":
            why = "While a goal was running your server accepted this one, which no robot can reach."
            check = "outside" if kind == "outside" else "not_a_number"
            raise Failed(evidence, why, "action.accepts_impossible", breaks=check)
        self.require_one_at_a_time(node, first, second, evidence)
        raise _OverError(evidence, "The first goal was over before the second arrived.")

    def require_one_at_a_time(
        self, node: GradedNode, first: GradedGoal, second: GradedGoal, evidence: Evidence
    ) -> None:
        """Of two goals that were accepted the server's own statuses say whether both ran at the same time.

        Raises:
            Failed: they did.
        """
        with node.context.record.looking_away():
            node.context.wait_until(lambda: bool(first.began_at and second.began_at), _PROMPT_S)
        later = max(first.began_at, second.began_at)
        if any(goal.over_at is not None and goal.over_at <= later for goal in (first, second)):
            return
        with node.context.record.looking_away():
            node.context.wait_until(lambda: first.over_at is not None, _PROMPT_S)
        if first.over_at is not None and first.statuses[-1][1] in (ABORTED, CANCELED):
            why = "Your server ended the first goal when the second arrived. It has to reject the second instead."
            raise Failed(evidence, why, breaks="second_goal")
        both = bool(second.feedback) and second.feedback[0].came_s < (first.over_at or math.inf)
        why = "Your server accepted a second goal while the first was still running."
        raise Failed(evidence, why, "action.concurrent_goals" if both else None, breaks="second_goal")

    @rule("second_goal", angles=drawn(lambda rng: [rng.uniform(0.0, 2.0 * math.pi) for _ in range(2 * _PAIRS)]))
    def send_two(self, node: GradedNode, angles: list[float]) -> None:
        """Of two goals in the same instant one is accepted, and reaches its target."""
        self.fairly(node, lambda: self._send_two(node, angles))

    def _send_two(self, node: GradedNode, angles: list[float]) -> None:
        expected = "one of the two goals accepted, the other rejected"
        for one, other in zip(angles[::2], angles[1::2], strict=True):
            begin = self.at
            targets = [_inside(begin, 0.5, angle) for angle in (one, other)]
            pair = [self.send(node, target, 0.0) for target in targets]
            for goal in pair:
                goal.wait_for_answer(expected, _allowed_s(0.5))
            sent = f"{pair[0].shown}; in the same instant {pair[1].shown}"
            accepted = [goal for goal in pair if goal.accepted]
            if not accepted:
                node.context.spoil()
                why = "The robot was free, so one of the two goals has to be accepted."
                raise Failed(Evidence(sent, expected, "both rejected"), why, breaks="second_goal")
            if len(accepted) > 1:
                evidence = Evidence(sent, expected, "both goals accepted")
                self.require_one_at_a_time(node, pair[0], pair[1], evidence)
                raise _OverError(evidence, "One goal was over before the other began.")
            target = targets[pair.index(accepted[0])]
            ended = self.arrive(accepted[0], math.dist(begin, target), breaks="second_goal")
            _judge("arrives", Move(begin, target, accepted[0], ended), breaks="second_goal")
        self.note("second_goal")

    # --- cancelling

    @rule("cancel", way=_ways(between(1.8, 2.4)), share=either(0.0, 0.02, 0.1, 0.35, 0.5, 0.7))
    def stop(self, node: GradedNode, way: _Way, share: float) -> None:
        """A goal is cancelled: in time, short of the target."""
        self.fairly(node, lambda: self.cancel(node, way, share))

    @rule("after_cancel", way=_ways(between(1.8, 2.4)), share=either(0.1, 0.4), then=_ways(*_LONG))
    def go_on(self, node: GradedNode, way: _Way, share: float, then: _Way) -> None:
        """The goal after a cancelled one works, and starts where the robot stopped."""

        def act() -> None:
            self.cancel(node, way, share)
            self.judge_known(node, self.drive(node, then, check="after_cancel"), "after_cancel")

        self.fairly(node, act)

    def cancel(self, node: GradedNode, way: _Way, share: float) -> None:
        """Set off, cancel after a share of the way, and see that the robot stops."""
        begin, target, stopped = self.at, self.target_of(node, way), self.stopped
        goal = self.send(node, target, 0.0)
        self.have_accepted(node, goal, target)
        self.wait_for_share(node, goal, begin, target, share)
        goal.shown += ", and mid-way the request to cancel it"
        again = "after_cancel" if "after_cancel" in self.happened else "cancel"
        try:
            goal.cancelled()
        except Failed as failed:
            self.judge_refusal(node, goal, failed, length=math.dist(begin, target), breaks=again)
        expected = "cancelling accepted within 1 s, then CANCELED short of the target"
        ended = goal.wait_for_end(_allowed_s(math.dist(begin, target)), expected)
        evidence = Evidence(goal.shown, expected, describe_end(ended))
        try:
            _feedback.require_stopped(goal, ended, evidence, begin, target)
        except Failed as failed:
            node.context.spoil()
            failed.breaks = "after_cancel" if stopped else "cancel"
            raise
        self.at = place_of(ended.result.final_position)
        drove = math.dist(begin, self.at)
        if "distance" in self.right - self.wrong and not abs(ended.result.distance_travelled - drove) <= max(
            0.05, 0.05 * drove
        ):
            why = f"The robot drove {drove:.2f} m before it was cancelled, but distance_travelled says something else."
            raise Failed(evidence, why, breaks="distance")
        self.note("after_cancel")
        self.stopped = True

    def judge_refusal(self, node: GradedNode, goal: GradedGoal, failed: Failed, *, length: float, breaks: str) -> None:
        """A request to cancel was not accepted in time: refused, or was the robot there already?

        Raises:
            Failed: it was refused, or answered too late.
        """
        failed.breaks = breaks
        if failed.diagnosis == "service.blocks":
            failed.diagnosis = "action.cancel_blocked"
        slow = self.is_slow(node.context)
        if failed.diagnosis == "action.cancel_refused" and goal.over_at is None and not slow:
            clock = node.context.clock()
            with node.context.record.looking_away():
                self.arrive(goal, length)
            if clock.wall() <= _REFUSED_S:
                raise _OverError(failed.evidence, failed.message)
            raise failed
        node.context.spoil()
        if goal.over_at is not None:
            raise HastyError(failed.evidence, failed.message, failed.diagnosis, breaks=breaks)
        raise failed

    # --- inside

    def leave_the_cancelled(self, node: GradedNode) -> None:
        """After a cancelled goal a plain move comes first: what is wrong with it has that cause."""
        if self.stopped:
            self.judge_known(node, self.drive(node, _Way(1.1, 0.5), check="after_cancel"), "after_cancel")

    def note(self, check: str) -> None:
        """Note down what has happened, by the check that is about it."""
        self.before = check
        if check not in self.happened:
            self.happened.append(check)

    def judged(self, node: GradedNode, way: _Way, aspect: str) -> None:
        """Drive, and have one aspect of the move right."""

        def act() -> None:
            stopped = self.stopped
            move = self.drive(node, way)
            if stopped and aspect in self.right - self.wrong:
                self.judge_known(node, move, "after_cancel")
            else:
                self.judge(move)
                _judge(aspect, move)

        self.fairly(node, act)

    def judge(self, move: Move) -> None:
        """Note down in which aspects a plain move was right."""
        for aspect in _ASPECTS if move.length >= 1.0 else ("arrives", "distance"):
            (self.right if _is_right(aspect, move) else self.wrong).add(aspect)

    def judge_known(self, node: GradedNode, move: Move, check: str) -> None:
        """A move is right wherever plain ones are; else it is the fault of what is special about it.

        If the next plain move is wrong as well, it is not.
        """
        aspect = next((each for each in sorted(self.right - self.wrong) if not _is_right(each, move)), "")
        if not aspect:
            return
        with node.context.record.looking_away():
            self.judge(self.drive(node, _Way(1.1, 0.5)))
        _judge(aspect, move, breaks=aspect if aspect in self.wrong else check)

    def fairly(self, node: GradedNode, act: Callable[[], object]) -> None:
        """Do a step; what may be the fast robot's fault, or a busy machine's, is done again at its own speed."""
        context, again = node.context, True
        speed = _speed_of(context)
        while True:
            clock = context.clock()
            try:
                act()
            except _OverError:
                self.use_speed(node, own=False)
                return
            except HastyError:
                slow = self.is_slow(context)
                if slow and not (again and clock.grader_lost() > _BLIND * clock.wall()):
                    context.spoil()
                    speed.own = False  # what else there is to see, the fast robot shows
                    raise
                again = not slow
            except Failed:
                context.spoil()
                raise
            else:
                if speed.own and speed.needed < _OFTEN:
                    self.use_speed(node, own=False)
                return
            speed.needed += 1
            self.right, self.wrong = set(), set()
            self.use_speed(node, own=True)
            context.record.clear()

    def use_speed(self, node: GradedNode, *, own: bool) -> None:
        """Start the program again, with the robot at one of its two speeds; a stranger's stays as it is."""
        if node.context.job.mode == "attach":
            return
        _speed_of(node.context).own = own
        self.start_afresh(node)

    def start_afresh(self, node: GradedNode) -> None:
        """Start the program again, and with it the model."""
        context = node.context
        context.launch(variables=_OWN_SPEED if _speed_of(context).own else None)
        node.meet()
        self.at, self.stopped, self.before, self.happened = _ORIGIN, False, "accepted", []

    @staticmethod
    def is_slow(context: CheckContext) -> bool:
        """Whether the robot that runs now drives at 1 m/s."""
        return context.job.mode == "attach" or _speed_of(context).own

    def target_of(self, node: GradedNode, way: _Way) -> Place:
        """Where a drawn way leads from here."""
        longest = _LONGEST_AT_OWN_SPEED_M if self.is_slow(node.context) else way.length
        return _inside(self.at, min(way.length, longest), way.angle)

    def send(self, node: GradedNode, target: Place, z: float) -> GradedGoal:
        """Send a goal."""
        goal = node.goal(ACTION, target={"x": target.x, "y": target.y, "z": z})
        goal.shown = f"a goal with target=({target.x:.4g}, {target.y:.4g}, {z:.4g})"
        return goal

    def have_accepted(
        self, node: GradedNode, goal: GradedGoal, target: Place, z: float = 0.0, breaks: str = ""
    ) -> None:
        """A valid goal is accepted; else find out what the server minds: what was before, this goal, or all goals."""
        try:
            goal.wait_for_answer("the goal accepted")
        except Failed as failed:
            failed.breaks = self.before
            raise
        if goal.accepted:
            return
        context, evidence = node.context, Evidence(goal.shown, "the goal accepted", "the goal rejected")
        process = goal.process()
        context.spoil()
        if context.job.mode != "attach" and self.is_accepted_afresh(node, target, z):
            why = (
                "No goal was running any more, and after a fresh start your node accepts this same goal: "
                "it never clears its mark that a goal is running."
            )
            raise Failed(evidence, why, breaks=self.cause_of_rejection(node))
        if not breaks and context.job.mode != "attach":
            others = [Place(2.0, 1.0), Place(5.0, 5.0)]
            accepted = next((other for other in others if self.is_accepted_afresh(node, other, 0.0)), None)
            if accepted is None:
                why = f"Each of {len(others) + 1} goals in the arena was rejected."
                if _NO_RESPONSE in process.stderr:
                    why += " Your goal callback did not return a GoalResponse; rclpy takes that as a rejection."
                raise Failed(evidence, why, "action.rejects_all", breaks="accepted")
            why = f"This target lies in the arena, and so does {accepted}, which your server accepted."
            raise Failed(evidence, why, "validation.overzealous", breaks="accepted")
        why = "This goal can be reached: it lies in the arena, and z does not matter."
        if breaks == "outside":
            why = "This target lies on an edge of the arena, and the edges belong to it."
        raise Failed(evidence, why, "validation.overzealous", breaks=breaks or "accepted")

    def cause_of_rejection(self, node: GradedNode) -> str:
        """The check about what keeps a server from accepting goals: found by doing each thing that happened, alone."""
        trials: dict[str, Callable[[], object]] = {
            "succeeds": lambda: self.send(node, Place(0.3, 0.2), 0.0).ends(within_s=_allowed_s(0.4)),
            "already_there": lambda: self.send(node, _ORIGIN, 0.0).ends(within_s=_allowed_s(0.0)),
            "not_a_number": lambda: self.send(node, Place(math.nan, 5.0), 0.0).rejected(),
            "outside": lambda: self.send(node, Place(-1.0, 5.0), 0.0).rejected(),
        }
        with node.context.record.looking_away():
            for check in [each for each in self.happened if each in trials]:
                with suppress(Failed):
                    trials[check]()
                    after = self.send(node, Place(0.6, 0.4), 0.0)
                    after.wait_for_answer("the goal accepted")
                    if not after.accepted:
                        node.context.spoil()
                        return check
                node.context.spoil()
        return next((check for check in ("after_cancel", "second_goal") if check in self.happened), self.before)

    def is_accepted_afresh(self, node: GradedNode, target: Place, z: float) -> bool:
        """Whether a program that has just been started accepts a goal."""
        again = self.send(node, target, z)
        again.wait_for_answer("the goal accepted")
        node.context.spoil()
        return again.accepted

    def drive(self, node: GradedNode, way: _Way, z: float = 0.0, check: str = "") -> Move:
        """Drive to the end of a drawn way; a failure costs the check that is named."""
        begin, target = self.at, self.target_of(node, way)
        goal = self.send(node, target, z)
        self.have_accepted(node, goal, target, z, breaks=check)
        ended = self.arrive(goal, math.dist(begin, target), breaks=check or "succeeds")
        self.note("succeeds")
        return Move(begin, target, goal, ended)

    def arrive(self, goal: GradedGoal, length: float, within_s: float = 0.0, breaks: str = "succeeds") -> Ended:
        """The goal ends SUCCEEDED; the robot is then where the result says."""
        ended = goal.ends("SUCCEEDED", within_s=within_s or _allowed_s(length), breaks=breaks)
        self.at = _feedback.in_the_arena(place_of(ended.result.final_position))
        self.stopped = False
        return ended

    def wait_for_share(self, node: GradedNode, goal: GradedGoal, begin: Place, target: Place, share: float) -> None:
        """Wait until feedback says that so much of the way is done, or for so long as that may take."""
        share = min(share, _LATEST_AT_OWN_SPEED) if self.is_slow(node.context) else share
        if share == 0.0:
            return
        length, clock = math.dist(begin, target), node.context.clock()

        def done() -> bool:
            seen = [one.feedback.distance_remaining for one in goal.feedback[-1:]]
            return goal.over_at is not None or (bool(seen) and seen[0] <= (1.0 - share) * length)

        speed = 1.0 if self.is_slow(node.context) else 10.0
        node.context.wait_until(
            lambda: done() or clock.wall() > 1.3 * share * length / speed + 0.05, _allowed_s(length)
        )


def _speed_of(context: CheckContext) -> _Speed:
    speed: _Speed = context.conversations.setdefault(_Speed, _Speed())
    return speed


def _inside(here: Place, length: float, angle: float) -> Place:
    """The place in the arena so far away, in this direction or the next one that stays inside."""
    for turn in range(24):
        turned = angle + turn * 2.4
        place = Place(here.x + length * math.cos(turned), here.y + length * math.sin(turned))
        if all(0.0 <= value <= ARENA for value in place):
            return place
    return Place(ARENA / 2, ARENA / 2)


def _allowed_s(length: float) -> float:
    return _SLOWEST_S * length + _EXTRA_S


def _is_right(aspect: str, move: Move) -> bool:
    try:
        _judge(aspect, move)
    except Failed:
        return False
    return True


def _judge(aspect: str, move: Move, breaks: str = "") -> None:
    """One aspect of a move that ended SUCCEEDED is right."""
    judge = {
        "arrives": _require_arrived,
        "distance": _require_distance,
        "feedback": _feedback.require_enough,
        "progress": _feedback.require_sense,
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
    if not _feedback.misses(final, move.target):
        return
    if _feedback.is_blank(move.ended.result):
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
    if abs(travelled - math.dist(_ORIGIN, move.target)) <= tolerance:
        why = f"That is the distance from {_ORIGIN}, but the robot was at {move.begin} when this goal arrived."
    elif travelled > move.length:
        why = "distance_travelled is more than this move: does it count earlier moves, too?"
    elif travelled == 0.0:
        why = "The field was not filled in."
    else:
        why = "That is less than the straight line to the target."
    raise Failed(evidence, why)


_AFTER_ARRIVAL = ("arrives",)
CHECKS = [
    offered(
        points=1.0,
        proves=["action", "only_a_class", "a_program", "start"],
        title="The action /move_robot is there, with its type",
    ),
    node_name("move_robot_server", points=0.5, proves=["node"], after=["offered"]),
    *conversation(
        RobotModel,
        part("accepted", "A goal in the arena is accepted", points=1.0, proves=["reaches", "a_program"]),
        part(
            "succeeds",
            "A goal in the arena ends SUCCEEDED, with a result",
            points=2.0,
            proves=["reaches", "in_time"],
            after=["accepted"],
        ),
        part(
            "arrives",
            "The robot is at the target when the goal has succeeded",
            points=2.0,
            proves=["reaches", "final_position", "position"],
            after=["succeeds"],
        ),
        part(
            "distance",
            "The distance travelled is the length of this move",
            points=1.0,
            proves=["distance_travelled"],
            after=_AFTER_ARRIVAL,
        ),
        part(
            "any_z", "The z of a target is ignored, whatever it is", points=1.0, proves=["any_z"], after=_AFTER_ARRIVAL
        ),
        part(
            "already_there",
            "A goal at the present position succeeds at once",
            points=1.0,
            proves=["already_there", "progress_limits"],
            after=_AFTER_ARRIVAL,
        ),
        part(
            "feedback",
            "While the robot moves, at least five feedback messages a metre tell where it is",
            points=2.0,
            proves=["five_a_metre", "spread", "straight"],
            after=_AFTER_ARRIVAL,
        ),
        part(
            "progress",
            "Progress grows, the distance left shrinks, the position is on the straight line",
            points=1.5,
            proves=["straight", "position", "progress_limits", "monotonic", "distance_remaining"],
            after=["feedback"],
        ),
        part(
            "second_goal",
            "A goal is rejected while another one runs, also when both are sent in the same instant",
            points=1.5,
            proves=["second_goal", "same_instant"],
            after=_AFTER_ARRIVAL,
        ),
        part(
            "cancel",
            "A goal is cancelled at any moment: within 1 s, short of the target",
            points=2.0,
            proves=["cancel_accepted", "cancelled", "one_thread", "position"],
            after=_AFTER_ARRIVAL,
        ),
        part(
            "after_cancel",
            "After a cancelled goal the next one works, and starts where the robot stopped",
            points=1.0,
            proves=["after_cancel", "cancel_accepted"],
            after=["cancel"],
        ),
        part(
            "not_a_number",
            "Goals that are NaN or infinite are rejected",
            points=1.0,
            proves=["not_a_number"],
            after=["accepted"],
        ),
        part(
            "outside",
            "Goals outside the arena are rejected, goals on its edges are not",
            points=1.5,
            proves=["edges_inside", "outside"],
            after=["accepted"],
        ),
        steps=50,
        after=["offered"],
        deadline_s=120.0,
    ),
]

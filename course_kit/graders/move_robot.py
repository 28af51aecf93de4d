"""Exercise 2: the action /move_robot, which drives a simulated robot, in a conversation with a model.

Read `CHECKS` first, then the rules of `RobotModel`: each does one thing with the robot, in an order that is drawn.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from course_interfaces.action import MoveRobot

from course_kit.graders import _feedback
from course_kit.graders._driving import SCALE, DrivingModel, OverError, Way, allowed_s, inside
from course_kit.graders._feedback import ARENA, ArenaPoint, HastyError, Move, describe_end, place_of
from course_kit.grading.checks.vocabulary import (
    Evidence,
    Failed,
    GradedGoal,
    GradedNode,
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

INTERFACES = (MoveRobot,)
VARIABLES = {SCALE: "0.1"}
_AT_ONCE_S = 1.0  # a goal at the present position
_NEAR_M = 2.5  # farther edges are not driven to: that they are accepted is enough
_REFUSED_S = 0.03  # who goes on for longer after refusing to cancel was not there yet
_PAIRS = 4  # of goals in the same instant: which callback comes first is a matter of chance
_LONG = (between(1.0, 1.5), between(1.0, 2.2))
_SHORT = (between(0.06, 0.2), between(0.2, 0.9))
_ANGLE = between(0.0, 2.0 * math.pi)
_ANY_Z = either(0.0, 0.0, -1.0, 2.5, math.nan)
_BESIDE_THE_ARENA = tuple(
    target for off in (-0.001, ARENA + 0.001, ARENA + 500.0, -20.0) for target in ((off, 5.0), (5.0, off))
)
_NO_PLACES = tuple(target for value in (math.nan, math.inf, -math.inf) for target in ((value, 5.0), (5.0, value)))


def _ways(*lengths: Any) -> Any:
    def make(rng: random.Random) -> Way:
        chosen = rng.choice(lengths)
        return Way(chosen.make(rng), rng.uniform(0.0, 2.0 * math.pi))

    return drawn(make)


class RobotModel(DrivingModel):
    """What may be asked of the robot, in any order."""

    # --- plain moves

    @rule("succeeds", way=_ways(*_LONG), often=2)
    def succeed(self, node: GradedNode, way: Way) -> None:
        """A goal in the arena is reached."""
        self.fairly(node, lambda: self.drive(node, way))

    @rule("arrives", way=_ways(*_LONG, *_SHORT), often=2)
    def get_there(self, node: GradedNode, way: Way) -> None:
        """The robot is where it has to be."""
        self.judged(node, way, "arrives")

    @rule("distance", way=_ways(*_LONG, *_SHORT), often=2)
    def measure(self, node: GradedNode, way: Way) -> None:
        """The result has the way of this goal."""
        self.judged(node, way, "distance")

    @rule("any_z", way=_ways(*_LONG, *_SHORT), z=either(2.5, math.nan, -1.0))
    def ignore_z(self, node: GradedNode, way: Way, z: float) -> None:
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
    def report(self, node: GradedNode, way: Way) -> None:
        """There is feedback all along."""
        self.judged(node, way, "feedback")

    @rule("progress", way=_ways(*_LONG, *_SHORT), often=4)
    def make_progress(self, node: GradedNode, way: Way) -> None:
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
            _feedback.judge("arrives", Move(self.at, self.at, goal, ended), breaks="already_there")
            self.note("already_there")

        self.fairly(node, act)

    @rule("outside", corner=either((0.0, 0.0), (ARENA, ARENA)))
    def reach_edge(self, node: GradedNode, corner: tuple[float, float]) -> None:
        """The edges belong to the arena."""

        def act() -> None:
            target = ArenaPoint(*corner)
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
        self.reject(
            node, ArenaPoint(*target), z, f"this goal, which lies outside the arena (0 to {ARENA:g} m)", "outside"
        )

    @rule("not_a_number", target=either(*_NO_PLACES), z=_ANY_Z)
    def send_nowhere(self, node: GradedNode, target: tuple[float, float], z: float) -> None:
        """A target that is no place is rejected."""
        self.reject(node, ArenaPoint(*target), z, "this goal, which is not a place", "not_a_number")

    def reject(self, node: GradedNode, target: ArenaPoint, z: float, what: str, check: str) -> None:
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
    def disturb(self, node: GradedNode, way: Way, moment: tuple[float, str], angle: float) -> None:
        """A goal that comes while another one runs is rejected, and changes nothing."""
        self.fairly(node, lambda: self._disturb(node, way, moment, angle))

    def _disturb(self, node: GradedNode, way: Way, moment: tuple[float, str], angle: float) -> None:
        share, kind = moment
        self.leave_the_cancelled(node)
        begin, target = self.at, self.target_of(node, way)
        first = self.send(node, target, 0.0)
        self.have_accepted(node, first, target)
        self.wait_for_share(node, first, begin, target, share)
        other = {"outside": ArenaPoint(-0.5, 5.0), "nowhere": ArenaPoint(math.nan, 5.0)}.get(kind)
        other = other or inside(begin, 1.0, angle)
        for target_of_other, what in ((other, kind), (inside(begin, 0.6, angle + 1.0), "second")):
            self._reject_second(node, first, target_of_other, what)
        length = math.dist(begin, target)
        ended = self.arrive(first, length, breaks="second_goal")
        self.judge_known(node, Move(begin, target, first, ended), "second_goal")
        self.note("second_goal")

    def _reject_second(self, node: GradedNode, first: GradedGoal, target: ArenaPoint, kind: str) -> None:
        """A goal is rejected while another one runs."""
        second = self.send(node, target, 0.0)
        expected = "the second goal rejected while the first runs"
        second.wait_for_answer(expected, allowed_s(math.dist(self.at, target)))
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
        raise OverError(evidence, "The first goal was over before the second arrived.")

    @rule("second_goal", angles=drawn(lambda rng: [rng.uniform(0.0, 2.0 * math.pi) for _ in range(2 * _PAIRS)]))
    def send_two(self, node: GradedNode, angles: list[float]) -> None:
        """Of two goals in the same instant one is accepted, and reaches its target."""
        self.fairly(node, lambda: self._send_two(node, angles))

    def _send_two(self, node: GradedNode, angles: list[float]) -> None:
        expected = "one of the two goals accepted, the other rejected"
        for one, other in zip(angles[::2], angles[1::2], strict=True):
            begin = self.at
            targets = [inside(begin, 0.5, angle) for angle in (one, other)]
            pair = [self.send(node, target, 0.0) for target in targets]
            for goal in pair:
                goal.wait_for_answer(expected, allowed_s(0.5))
            sent = f"{pair[0].shown}; in the same instant {pair[1].shown}"
            accepted = [goal for goal in pair if goal.accepted]
            if not accepted:
                node.context.spoil()
                why = "The robot was free, so one of the two goals has to be accepted."
                raise Failed(Evidence(sent, expected, "both rejected"), why, breaks="second_goal")
            if len(accepted) > 1:
                evidence = Evidence(sent, expected, "both goals accepted")
                self.require_one_at_a_time(node, pair[0], pair[1], evidence)
                raise OverError(evidence, "One goal was over before the other began.")
            target = targets[pair.index(accepted[0])]
            ended = self.arrive(accepted[0], math.dist(begin, target), breaks="second_goal")
            _feedback.judge("arrives", Move(begin, target, accepted[0], ended), breaks="second_goal")
        self.note("second_goal")

    # --- cancelling

    @rule("cancel", way=_ways(between(1.8, 2.4)), share=either(0.0, 0.02, 0.1, 0.35, 0.5, 0.7))
    def stop(self, node: GradedNode, way: Way, share: float) -> None:
        """A goal is cancelled: in time, short of the target."""
        self.fairly(node, lambda: self.cancel(node, way, share))

    @rule("after_cancel", way=_ways(between(1.8, 2.4)), share=either(0.1, 0.4), then=_ways(*_LONG))
    def go_on(self, node: GradedNode, way: Way, share: float, then: Way) -> None:
        """The goal after a cancelled one works, and starts where the robot stopped."""

        def act() -> None:
            self.cancel(node, way, share)
            self.judge_known(node, self.drive(node, then, check="after_cancel"), "after_cancel")

        self.fairly(node, act)

    def cancel(self, node: GradedNode, way: Way, share: float) -> None:
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
        ended = goal.wait_for_end(allowed_s(math.dist(begin, target)), expected)
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
                raise OverError(failed.evidence, failed.message)
            raise failed
        node.context.spoil()
        if goal.over_at is not None:
            raise HastyError(failed.evidence, failed.message, failed.diagnosis, breaks=breaks)
        raise failed


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

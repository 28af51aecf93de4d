"""Exercise 2: a robot that is driven by goals: where it is, at which of two speeds, and what its moves have shown.

The robot is made fast by COURSE_KIT_TIME_SCALE; what a learner's own clock, or a busy machine, might have spoiled is
done again at the robot's own speed before it counts.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.graders import _feedback
from course_kit.graders._feedback import ARENA, ORIGIN, ArenaPoint, HastyError, Move, place_of
from course_kit.grading.checks.goals import ABORTED, CANCELED
from course_kit.grading.checks.vocabulary import Evidence, Failed, GradedGoal, GradedNode, Model

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.goals import Ended

ACTION = "/move_robot"
SCALE = "COURSE_KIT_TIME_SCALE"
_OWN_SPEED = {SCALE: "1"}
_SLOWEST_S, _EXTRA_S = 3.0, 2.0  # a move may take so long a metre, and so much more
_LONGEST_AT_OWN_SPEED_M = 1.6
_PROMPT_S = 1.0  # within which the statuses of two goals have come
_OFTEN = 3  # times that the fast robot was too fast, after which the own speed stays
_LATEST_AT_OWN_SPEED = 0.5  # share of a way, after which the grader might come too late
_BLIND = 0.3  # of the time of a step, without which the grader cannot judge when something was sent
_NO_RESPONSE = "did not return a GoalResponse type"  # rclpy's warning
_ASPECTS = ("arrives", "distance", "feedback", "progress")  # of a move, each the id of a check


class OverError(Failed):
    """What was to be seen was over before the grader could see it, at the robot's own speed: it shows nothing."""


@dataclass
class _Speed:
    """Kept with the conversation: whether the robot that runs now has its own speed, and how often that was needed."""

    own: bool = False
    needed: int = 0


@dataclass(frozen=True)
class Way:
    """A drawn move, relative to where the robot is."""

    length: float
    angle: float


class DrivingModel(Model):
    """Where the robot is, and what plain moves have shown to be right."""

    def __init__(self) -> None:
        self.at = ORIGIN
        self.before = "accepted"  # the check that is about what happened last
        self.stopped = False  # by a cancel, and has not arrived anywhere since
        self.happened: list[str] = []  # these checks, in the order of their first time
        self.right: set[str] = set()  # the aspects in which plain moves were right
        self.wrong: set[str] = set()  # those in which one was not

    def begin(self, node: GradedNode) -> None:
        """Have the robot at its own speed where the fast one was too fast; look where a stranger's robot is."""
        context = node.context
        if context.job.mode == "attach":
            goal = self.send(node, ArenaPoint(ARENA / 2, ARENA / 2), 0.0)
            self.have_accepted(node, goal, ArenaPoint(ARENA / 2, ARENA / 2))
            self.arrive(goal, math.hypot(ARENA, ARENA))
        elif _speed_of(context).own:
            self.start_afresh(node)

    def leave_the_cancelled(self, node: GradedNode) -> None:
        """After a cancelled goal a plain move comes first: what is wrong with it has that cause."""
        if self.stopped:
            self.judge_known(node, self.drive(node, Way(1.1, 0.5), check="after_cancel"), "after_cancel")

    def note(self, check: str) -> None:
        """Note down what has happened, by the check that is about it."""
        self.before = check
        if check not in self.happened:
            self.happened.append(check)

    def judged(self, node: GradedNode, way: Way, aspect: str) -> None:
        """Drive, and have one aspect of the move right."""

        def act() -> None:
            stopped = self.stopped
            move = self.drive(node, way)
            if stopped and aspect in self.right - self.wrong:
                self.judge_known(node, move, "after_cancel")
            else:
                self.judge(move)
                _feedback.judge(aspect, move)

        self.fairly(node, act)

    def judge(self, move: Move) -> None:
        """Note down in which aspects a plain move was right."""
        for aspect in _ASPECTS if move.length >= 1.0 else ("arrives", "distance"):
            (self.right if _feedback.is_right(aspect, move) else self.wrong).add(aspect)

    def judge_known(self, node: GradedNode, move: Move, check: str) -> None:
        """A move is right wherever plain ones are; else it is the fault of what is special about it.

        If the next plain move is wrong as well, it is not.
        """
        aspect = next((each for each in sorted(self.right - self.wrong) if not _feedback.is_right(each, move)), "")
        if not aspect:
            return
        with node.context.record.looking_away():
            self.judge(self.drive(node, Way(1.1, 0.5)))
        _feedback.judge(aspect, move, breaks=aspect if aspect in self.wrong else check)

    def fairly(self, node: GradedNode, act: Callable[[], object]) -> None:
        """Do a step; what may be the fast robot's fault, or a busy machine's, is done again at its own speed."""
        context, again = node.context, True
        speed = _speed_of(context)
        while True:
            clock = context.clock()
            try:
                act()
            except OverError:
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
        self.at, self.stopped, self.before, self.happened = ORIGIN, False, "accepted", []

    @staticmethod
    def is_slow(context: CheckContext) -> bool:
        """Whether the robot that runs now drives at 1 m/s."""
        return context.job.mode == "attach" or _speed_of(context).own

    def target_of(self, node: GradedNode, way: Way) -> ArenaPoint:
        """Where a drawn way leads from here."""
        longest = _LONGEST_AT_OWN_SPEED_M if self.is_slow(node.context) else way.length
        return inside(self.at, min(way.length, longest), way.angle)

    def send(self, node: GradedNode, target: ArenaPoint, z: float) -> GradedGoal:
        """Send a goal."""
        goal = node.goal(ACTION, target={"x": target.x, "y": target.y, "z": z})
        goal.shown = f"a goal with target=({target.x:.4g}, {target.y:.4g}, {z:.4g})"
        return goal

    def have_accepted(
        self, node: GradedNode, goal: GradedGoal, target: ArenaPoint, z: float = 0.0, breaks: str = ""
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
            others = [ArenaPoint(2.0, 1.0), ArenaPoint(5.0, 5.0)]
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
            "succeeds": lambda: self.send(node, ArenaPoint(0.3, 0.2), 0.0).ends(within_s=allowed_s(0.4)),
            "already_there": lambda: self.send(node, ORIGIN, 0.0).ends(within_s=allowed_s(0.0)),
            "not_a_number": lambda: self.send(node, ArenaPoint(math.nan, 5.0), 0.0).rejected(),
            "outside": lambda: self.send(node, ArenaPoint(-1.0, 5.0), 0.0).rejected(),
        }
        with node.context.record.looking_away():
            for check in [each for each in self.happened if each in trials]:
                with suppress(Failed):
                    trials[check]()
                    after = self.send(node, ArenaPoint(0.6, 0.4), 0.0)
                    after.wait_for_answer("the goal accepted")
                    if not after.accepted:
                        node.context.spoil()
                        return check
                node.context.spoil()
        return next((check for check in ("after_cancel", "second_goal") if check in self.happened), self.before)

    def is_accepted_afresh(self, node: GradedNode, target: ArenaPoint, z: float) -> bool:
        """Whether a program that has just been started accepts a goal."""
        again = self.send(node, target, z)
        again.wait_for_answer("the goal accepted")
        node.context.spoil()
        return again.accepted

    def drive(self, node: GradedNode, way: Way, z: float = 0.0, check: str = "") -> Move:
        """Drive to the end of a drawn way; a failure costs the check that is named."""
        begin, target = self.at, self.target_of(node, way)
        goal = self.send(node, target, z)
        self.have_accepted(node, goal, target, z, breaks=check)
        ended = self.arrive(goal, math.dist(begin, target), breaks=check or "succeeds")
        self.note("succeeds")
        return Move(begin, target, goal, ended)

    def arrive(self, goal: GradedGoal, length: float, within_s: float = 0.0, breaks: str = "succeeds") -> Ended:
        """The goal ends SUCCEEDED; the robot is then where the result says."""
        ended = goal.ends("SUCCEEDED", within_s=within_s or allowed_s(length), breaks=breaks)
        self.at = _feedback.in_the_arena(place_of(ended.result.final_position))
        self.stopped = False
        return ended

    def wait_for_share(
        self, node: GradedNode, goal: GradedGoal, begin: ArenaPoint, target: ArenaPoint, share: float
    ) -> None:
        """Wait until feedback says that so much of the way is done, or for so long as that may take."""
        share = min(share, _LATEST_AT_OWN_SPEED) if self.is_slow(node.context) else share
        if share == 0.0:
            return
        length, clock = math.dist(begin, target), node.context.clock()

        def done() -> bool:
            seen = [one.feedback.distance_remaining for one in goal.feedback[-1:]]
            return goal.over_at is not None or (bool(seen) and seen[0] <= (1.0 - share) * length)

        speed = 1.0 if self.is_slow(node.context) else 10.0
        node.context.wait_until(lambda: done() or clock.wall() > 1.3 * share * length / speed + 0.05, allowed_s(length))

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


def _speed_of(context: CheckContext) -> _Speed:
    speed: _Speed = context.conversations.setdefault(_Speed, _Speed())
    return speed


def inside(here: ArenaPoint, length: float, angle: float) -> ArenaPoint:
    """The place in the arena so far away, in this direction or the next one that stays inside."""
    for turn in range(24):
        turned = angle + turn * 2.4
        place = ArenaPoint(here.x + length * math.cos(turned), here.y + length * math.sin(turned))
        if all(0.0 <= value <= ARENA for value in place):
            return place
    return ArenaPoint(ARENA / 2, ARENA / 2)


def allowed_s(length: float) -> float:
    return _SLOWEST_S * length + _EXTRA_S

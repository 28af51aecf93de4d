"""Exercise 2: the action /move_robot, which drives a simulated robot, in a conversation with a model.

Read `CHECKS`, then the rules of `RobotModel`. What fails with the fast robot is tried again at the robot's own speed.
"""

from __future__ import annotations

import math
import time
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from course_kit.graders import _moves
from course_kit.graders._moves import A_SECOND, ARENA, CENTRE, ORIGIN, ArenaPoint, HastyError, Move, Way, place_inside
from course_kit.grading.checks.evidence import Evidence, Failed, UnansweredError, UnseenError, charge_to
from course_kit.grading.checks.graded_goal import CANCELED, SUCCEEDED
from course_kit.grading.checks.ready_made import endpoints_offered, node_name
from course_kit.grading.checks.vocabulary import CheckPart, Model, conversation, draw_between, draw_one_of, step_rule

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.checks.vocabulary import GradedGoal, GradedNode

VARIABLES, OWN_SPEED = {"COURSE_KIT_TIME_SCALE": "0.06"}, {"COURSE_KIT_TIME_SCALE": "1"}


def make_move_rule(check: str, way: Any) -> Callable[..., None]:
    """A rule of a check: a goal in the arena is reached, rightly in each aspect; what is lost of one is lost alone."""

    def move(model: RobotModel, node: GradedNode, way: Way) -> None:
        model.move_rightly(node, model.target_of(way))

    move.__name__ = f"move_for_{check}"
    return step_rule(check, way=way)(move)


class RobotModel(Model):
    """Where the robot is, and what may be asked of it, in any order."""

    def __init__(self) -> None:
        self.at = ORIGIN
        self.special = ""  # the check about what was more than a plain move, last
        self.cancelled = False  # a goal was, since the start
        self.ways: list[tuple[ArenaPoint, ArenaPoint]] = []  # that the robot was sent on since the start
        self._recent: dict[str, Callable[[], object]] = {}  # the last steps since then, by what was special
        self._judged: tuple[Move, int] | None = None  # the last move, and how much feedback there was then

    def begin(self, node: GradedNode) -> None:
        """Have the robot at its own speed where the fast one was too fast; look where a stranger's robot is."""
        self._known: _moves.Speed = _moves.speed_of(node.context)
        if node.context.job.mode == "attach":
            self.finish(self.at, CENTRE, self.start(node, CENTRE))
        elif self._known.own:
            self.start_afresh(node)

    move = make_move_rule("succeeds", _moves.SHORT_MOVES)
    arrive = make_move_rule("arrives", _moves.LONG_MOVES)
    hear = make_move_rule("feedback", _moves.LONG_MOVES)
    measure = make_move_rule("distance", _moves.SHORT_MOVES)

    @step_rule("succeeds", length=draw_between(3.0, 3.5))
    def move_along_walls(self, node: GradedNode, length: float) -> None:
        """So is one with the same x, far enough that what is short in a metre adds up, and one with the same y."""
        self.move_rightly(node, self.place_at(1.02 * _moves.LONG_M, 0.5))  # away from the edges
        x, y = self.at
        self.move_rightly(node, ArenaPoint(x, y + length if y < CENTRE.y else y - length))
        self.move_rightly(node, ArenaPoint(x + 1.23 if x < CENTRE.x else x - 1.23, self.at.y))

    @step_rule("any_z", way=_moves.LONG_MOVES)
    def ignore_z(self, node: GradedNode, way: Way) -> None:
        """Whatever stands in z changes nothing."""
        self.make_plain_move(node)
        for z in (math.nan, math.inf, -1.0):
            self.special = "any_z"
            self.drive(node, self.target_of(way), z, "any_z")

    @step_rule("already_there", angle=_moves.ANGLE, often=2)
    def be_there(self, node: GradedNode, angle: float) -> None:
        """A goal at the present position succeeds at once."""
        self.move_rightly(node, self.place_at(1.02 * _moves.LONG_M, angle))
        goal = self.start(node, self.at, breaks="already_there")
        self.ways[-1] = (self.at, self.place_at(0.3, angle))  # tried in its place when it may have spoiled something
        self.special = "already_there"
        ended = goal.ends(within_s=1.0, breaks="already_there")
        _moves.require_no_jump(goal, self.lost)
        self.judge(Move(self.at, self.at, goal, ended), "arrives")

    @step_rule("outside", at=draw_between(1.0, ARENA - 1.0))
    def reach_edges(self, node: GradedNode, at: float) -> None:
        """The edges belong to the arena, and so do its corners, between which the way is the longest."""
        corners = sorted((ORIGIN, _moves.CORNER), key=lambda corner: math.dist(corner, self.at))
        for target in (ArenaPoint(*place) for place in ((at, -0.0), (at, ARENA), (0.0, at), (ARENA, at), *corners)):
            driven = (target in corners and not self._known.own) or math.dist(self.at, target) <= _moves.SHORT_M
            if not driven and "cancel" not in self.lost and node.context.job.mode != "attach":
                self.cancel(node, target, 0.0, breaks="outside")
                continue
            self.make_plain_move(node, "outside")
            self.special = "outside"
            self.drive(node, target, breaks="outside")

    @step_rule("outside", targets=_moves.OUTSIDE, z=_moves.Z, often=3)
    def send_outside(self, node: GradedNode, targets: list[tuple[float, float]], z: float) -> None:
        """A target outside the arena is rejected, on each of its sides."""
        self.reject_each(node, targets, z, f"this goal, which lies outside the arena (0 to {ARENA:g} m)")

    @step_rule("not_a_number", targets=_moves.NO_PLACES, z=_moves.Z, often=3)
    def send_nowhere(self, node: GradedNode, targets: list[tuple[float, float]], z: float) -> None:
        """A target that is no place is rejected, whatever is wrong with it."""
        self.reject_each(node, targets, z, "this goal, which is not a place")

    @step_rule("second_goal", way=_moves.draw_way(draw_between(1.1, 1.4)), moment=_moves.MOMENTS, angle=_moves.ANGLE)
    def disturb(self, node: GradedNode, way: Way, moment: tuple[float, str], angle: float) -> None:
        """A goal that comes while another one runs is rejected, and changes nothing."""
        share, kind = moment
        self.make_plain_move(node, "second_goal")
        begin, target = self.at, self.target_of(way)
        first = self.set_off(node, target, share)
        self.special = "second_goal"
        others = {"outside": ArenaPoint(-0.5, 5.0), "nowhere": ArenaPoint(math.nan, 5.0), "same": target}
        self.reject_second(node, first, others.get(kind, self.place_at(1.0, angle)))
        clock, allowed_s = node.context.clock(), _moves.allowed_s(way.length)
        with suppress(UnseenError):  # the last one may have come when the first was over, and be right
            while first.over_at is None and not clock.has_passed(allowed_s):  # who halts for one halts for each
                self.reject_second(node, first, self.place_at(0.6, angle + 1.0))
                node.context.wait_until(lambda: first.over_at is not None, 0.2)
        then = self.at
        self.judge(self.finish(begin, target, first, max(allowed_s - clock.fair_s(), 1.0)))
        self.at = self.at if then == begin else then

    @step_rule("second_goal", angles=[_moves.ANGLE] * 8)  # four pairs: which callback comes first is a matter of chance
    def send_two(self, node: GradedNode, angles: list[float]) -> None:
        """Of two goals in the same instant one is accepted, and reaches its target."""
        self.make_plain_move(node, "second_goal")
        expected = "one of the two goals accepted, the other rejected"
        for left, other in zip(angles[::2], angles[1::2], strict=True):
            begin = self.at
            first, second = [_moves.send_goal(node, self.place_at(0.5, angle)) for angle in (left, other)]
            sent = f"{first.shown}; at the same instant {second.shown}"
            accepted = [goal for goal in (first, second) if goal.wait_for_answer(expected, _moves.allowed_s(0.5))]
            if not accepted:
                self.drive(node, self.place_at(0.5, left))  # which fails where the server accepts no more
                both = Evidence(sent, expected, "both goals rejected")
                raise Failed(both, "The robot was free: one has to be accepted.", breaks="second_goal")
            self.special = "second_goal"
            if len(accepted) > 1:
                self.see_one_at_a_time(node, first, second, Evidence(sent, expected, "both goals accepted"))
            target = self.place_at(0.5, left if accepted[0] is first else other)
            self.ways.append((begin, target))
            self.judge(self.finish(begin, target, accepted[0]), "arrives")

    @step_rule("second_goal", way=_moves.draw_way(draw_between(1.0, 1.4)), angle=_moves.ANGLE)
    def send_while_it_stops(self, node: GradedNode, way: Way, angle: float) -> None:
        """A cancelled goal runs until it has ended, and until then no other is accepted."""
        expected = "the second goal rejected until the first, which is being cancelled, has ended"
        for _ in range(1 if self._known.own else 2):  # of the fast one that is a matter of chance
            self.make_plain_move(node, "second_goal")
            begin, target = self.at, self.target_of(way)
            first = self.set_off(node, target, 0.1)
            self.special, other = "second_goal", self.place_at(0.7, angle)
            self.reject_second(node, first, other)
            first.cancel()
            second, clock = _moves.send_goal(node, other), node.context.clock()
            sent = f"{first.shown}; the request to cancel it, and at the same instant {second.shown}"
            evidence = Evidence(sent, expected, "accepted at once")
            with charge_to("succeeds" if "succeeds" in self.lost else "cancel"):
                while not (second.wait_for_answer(expected) or clock.has_passed(A_SECOND)):
                    if node.context.wait_until(lambda: first.over_at is not None, 0.05):  # noqa: B023 - called here
                        break
                    second = _moves.send_goal(node, other)
                if second.accepted and not self._known.own:
                    self._recent = {}  # whatever was before, the fast robot shows nothing of it
                    raise HastyError(evidence, "With the robot at its own speed, this can be seen.")
                ended = first.wait_for_end(_moves.allowed_s(way.length), expected)
            self.note_arrival(Move(begin, target, first, ended))
            self.special, self.cancelled = "after_cancel" if ended.status == CANCELED else "cancel", True
            if second.accepted:
                self.note_arrival(Move(self.at, other, second, second.wait_for_end(_moves.allowed_s(3.0), expected)))
                if ended.status == CANCELED and (first.over_at or 0.0) > second.began_at + _moves.OVERLAP_S:
                    why = "Your server accepted the second goal before the first, which it was to cancel, had ended."
                    raise Failed(evidence, why, breaks="second_goal")

    @step_rule("cancel", way=_moves.STOPS, share=_moves.CUTS, disturbed=draw_one_of(False, True), then=_moves.THEN)
    def stop(self, node: GradedNode, way: Way, share: float, disturbed: bool, then: Way | None) -> None:
        """A goal is cancelled in time, and ends short of the target; the next one, or the same again, starts there."""
        self.make_plain_move(node)
        length = (_moves.FAR_M if self._known.own else way.length) if share else 0.8  # at once, a short way, too
        target = self.target_of(Way(length, way.angle))
        self.cancel(node, target, share, disturbed=disturbed and share < 1.0)
        target = target if then is None else self.target_of(then)
        if math.dist(self.at, target) > _moves.TOLERANCE:
            self.move_rightly(node, target)

    # --- steps of the rules

    def reject_each(self, node: GradedNode, targets: list[tuple[float, float]], z: float, what: str) -> None:
        """Goals are rejected while the robot stands, by a server that accepts others."""
        if not self._known.accepted:
            self.drive(node, self.place_at(_moves.LONG_M, 0.5))
            self.start_afresh(node)
        for target in targets:
            _moves.send_goal(node, ArenaPoint(*target), z).rejected(what=what)
            self.special = "second_goal"  # whose sentence says that a rejected goal changes nothing

    def drive(self, node: GradedNode, target: ArenaPoint, z: float = 0.0, breaks: str = "") -> Move:
        """Drive to a target, rightly in each aspect."""
        return self.judge(self.finish(self.at, target, self.start(node, target, z, breaks)))

    def move_rightly(self, node: GradedNode, target: ArenaPoint) -> None:
        """A right move; a long one shows that what was special before it has left nothing."""
        if self.drive(node, target).length >= _moves.LONG_M:
            self.special = ""

    def start(self, node: GradedNode, target: ArenaPoint, z: float = 0.0, breaks: str = "") -> GradedGoal:
        """Send a goal, which is accepted; what rejects just this one costs the check that is named."""
        for check, ever in (("accepted", self._known.accepted), ("succeeds", self._known.succeeded)):
            if check in self.lost and not ever:  # nothing more can be seen of such goals
                raise Failed(Evidence(), "", breaks=check)
        self.ways.append((self.at, target))
        goal = _moves.send_goal(node, target, z)
        with charge_to("succeeds" if self.ways[:-1] else "accepted"):  # it has accepted goals before, or not
            if not goal.wait_for_answer("the goal accepted"):
                raise _moves.explain_rejection(node, goal, target, z, breaks)
        self._known.accepted = True
        return goal

    def finish(self, begin: ArenaPoint, target: ArenaPoint, goal: GradedGoal, within_s: float = 0.0) -> Move:
        """Wait until a move has succeeded, for so many seconds or as long as it may take."""
        ended = goal.ends(within_s=within_s or _moves.allowed_s(math.dist(begin, target)), breaks="succeeds")
        self._known.succeeded = True
        return self.note_arrival(Move(begin, target, goal, ended))

    def set_off(self, node: GradedNode, target: ArenaPoint, share: float, breaks: str = "") -> GradedGoal:
        """Begin a move, and wait until feedback says that a share of it is done, or for as long as that may take."""
        length, goal = math.dist(self.at, target), self.start(node, target, breaks=breaks)
        if share:
            seconds = 1.3 * share * length / (1.0 if self._known.own else 10.0) + 0.05
            node.context.wait_until(
                lambda: goal.over_at is not None or _moves.metres_left(goal, target) <= (1.0 - share) * length,
                seconds,
                step_s=0.005,
            )
        return goal

    def reject_second(self, node: GradedNode, first: GradedGoal, target: ArenaPoint) -> None:
        """A goal is rejected while another one runs."""
        second, expected = _moves.send_goal(node, target), "the second goal rejected while the first runs"
        second.wait_for_answer(expected)
        if first.shown.count("while it runs") < 2:  # noqa: PLR2004 - more of them tell no more
            first.shown = f"{first.shown}; while it runs, {second.shown}"
        if second.accepted:
            self.see_one_at_a_time(node, first, second, Evidence(first.shown, expected, "both goals accepted"))

    def see_one_at_a_time(self, node: GradedNode, first: GradedGoal, second: GradedGoal, evidence: Evidence) -> None:
        """Both goals were accepted: did they run at the same time?"""
        later = _moves.require_one_at_a_time(node.context, first, second, evidence)
        self.note_arrival(Move(self.at, self.at, later, later.wait_for_end(_moves.allowed_s(3.0), "SUCCEEDED")))
        raise UnseenError(evidence, "One goal was over before the other began.")

    def note_arrival(self, move: Move) -> Move:
        """The robot is then where the result says, unless that is nowhere in the arena or said wrongly."""
        place = _moves.place_of(move.ended.result.final_position)
        self.at = move.target if move.ended.status == SUCCEEDED else move.begin
        if move.ended.status == SUCCEEDED and "arrives" in self.lost:
            place = _moves.place_of(move.goal.feedback[-1].feedback.position) if move.goal.feedback else move.target
            move = replace(move, may_remain=_moves.TOLERANCE + math.dist(place, move.target))
        if all(-1.0 <= value <= ARENA + 1.0 for value in place):
            self.at = place
        return move

    def make_plain_move(self, node: GradedNode, check: str = "") -> None:
        """At first, and after something special of another check, comes a plain move: what is wrong has that cause."""
        if self.special not in ("", check) or not self._known.succeeded:
            self.move_rightly(node, self.place_at(1.02 * _moves.LONG_M, 0.5))

    def judge(self, move: Move, *aspects: str) -> Move:
        """A move is right in these aspects, or all, but for what is lost already."""
        before, self._judged = self._judged, None
        if before is not None and len(before[0].goal.feedback) > before[1]:  # after its result, say
            self.judge(before[0], "progress")
        lost = {*self.lost, "progress"} if "feedback" in self.lost else self.lost
        for aspect, require in _moves.ASPECTS.items():
            if aspect not in lost and (aspect in aspects or not aspects):
                with charge_to(aspect):
                    require(move)
        self._judged = (move, len(move.goal.feedback))
        return move

    def cancel(
        self, node: GradedNode, target: ArenaPoint, share: float, *, disturbed: bool = False, breaks: str = ""
    ) -> None:
        """Set off, cancel after a share of the way, or just before it is too late, and see that the robot stops."""
        slow, late, begin = self._known.own, share == 1.0 and "arrives" not in self.lost, self.at
        length = math.dist(begin, target)
        goal = self.set_off(node, target, 1.0 - 0.42 / length if late else min(share, 0.5), breaks)
        breaks = "after_cancel" if self.cancelled else "cancel"
        if disturbed and "second_goal" not in self.lost:
            self.reject_second(node, goal, self.place_at(0.6, target.x))
        goal.shown += ", and on the way the request to cancel it"
        clock, asked_s = node.context.clock(lambda: 0.0), time.time()
        try:
            goal.cancelled()
        except Failed as failed:
            failed.breaks = breaks
            driven = min(length, _moves.metres_left(goal, target, asked_s)) - _moves.metres_left(goal, target)
            failed.diagnosis = failed.diagnosis or ("action.cancel_blocked" if driven > A_SECOND else None)
            # However busy the machine is: who has driven so far meanwhile has had this much time.
            explained = _moves.explain_refusal(failed, goal, target, max(clock.fair_s(), driven / A_SECOND), slow=slow)
            if isinstance(explained, UnseenError):
                self.start_afresh(node)
            elif self.cancelled and node.context.job.mode != "attach" and self.refuses_first_cancel(node, share):
                explained.breaks = "cancel"
            raise explained from None
        self.special, clock = breaks, node.context.clock()
        left = _moves.metres_left(goal, target) if share else length
        with charge_to("succeeds"):  # a goal that never ends may be one of a server whose goals never end
            ended = goal.wait_for_end(_moves.allowed_s(length), "CANCELED within 1 s, before the target")
        took_s = clock.fair_s() if ended.status == CANCELED else 0.0
        move = self.note_arrival(Move(begin, target, goal, ended))
        _moves.require_stop(move, breaks, took_s, short=not late and (not slow or left >= A_SECOND))
        self.judge(move, "distance")
        self.special = ""  # what it says on the way it says wrongly, whatever the end
        self.judge(move, "progress")
        self.special, self.cancelled = "after_cancel", True

    def refuses_first_cancel(self, node: GradedNode, share: float) -> bool:
        """Whether cancelling after this share of the way goes wrong on a fresh start, too."""
        with node.context.record.looking_away():
            self.start_afresh(node)
            goal = self.set_off(node, self.place_at(2.0, 0.5), min(share, 0.8))
            with suppress(Failed):
                goal.cancelled()
                return False
        return True

    # --- at which speed, and whose fault

    def act(self, node: GradedNode, step: Callable[[], object]) -> None:
        """Do a step; what may be the fast robot's fault, or a busy machine's, is done again at its own speed."""
        context, speed, steps = node.context, self._known, [step]
        again, over = 0, list[UnseenError]()
        while len(over) < _moves.OFTEN:
            clock = context.clock()
            try:
                for before in steps[:-1]:
                    with suppress(UnseenError):
                        before()
                step()
                break
            except UnseenError as failed:
                over.append(failed)
            except Failed as failed:
                again += 1
                may_be_ours = not speed.own or clock.grader_lost() > 0.3 * clock.wall_s()  # nobody knows the order
                if isinstance(failed, HastyError) and again < _moves.OFTEN and may_be_ours:
                    speed.needed, speed.own = speed.needed + 1, True
                    steps = [*self._recent.values(), step]
                    self.start_afresh(node)
                    context.record.clear()
                    continue
                self.blame(node, failed)
                context.spoil()
                if failed.breaks not in self.lost or failed.breaks in ("accepted", "succeeds"):
                    speed.own = speed.needed >= _moves.OFTEN  # what else there is to see, the fast robot shows
                    raise
                self.start_afresh(node)
                break
        self._recent = {**self._recent, self.special: step}
        if speed.own and speed.needed < _moves.OFTEN:
            speed.own = False
            self.start_afresh(node)
        if len(over) == _moves.OFTEN and over[-1].breaks:
            raise over[-1]

    def blame(self, node: GradedNode, failed: Failed) -> None:
        """What is wrong with a move is the fault of what was special before it, if the moves alone go right."""
        if isinstance(failed, UnansweredError) and self.ways and not failed.diagnosis:
            failed.breaks = failed.breaks or "succeeds"  # nothing explains it but a goal before it
        of_moves = failed.breaks in ("accepted", "succeeds", *_moves.ASPECTS)
        if not of_moves or failed.breaks in self.lost or not self.special:
            return
        special, ways = self.special, self.ways[-8:]
        if node.context.job.mode != "attach":
            try:
                with node.context.record.looking_away():
                    self.start_afresh(node)
                    for begin, target in ways:
                        if math.dist(self.at, begin) > _moves.TOLERANCE:
                            self.finish(self.at, begin, self.start(node, begin))
                        self.judge(self.finish(self.at, target, self.start(node, target)), failed.breaks)
            except Failed:
                return
        if failed.breaks in _moves.ASPECTS:
            failed.diagnosis = None  # which is about moves alone
        without = "with z = 0" if special == "any_z" else "when nothing else is sent to your node"
        failed.message = f"{failed.message} The same moves work {without}."
        failed.instead, failed.breaks = failed.breaks, special

    def start_afresh(self, node: GradedNode) -> None:
        """Start the program again, at one of the robot's two speeds, and with it the model; a stranger's goes on."""
        if node.context.job.mode != "attach":
            node.context.launch(variables=OWN_SPEED if self._known.own else None)
            node.ensure_running()
            vars(self).update(vars(RobotModel()))

    def target_of(self, way: Way) -> ArenaPoint:
        """Where a drawn way leads; not too near to (0, 0), which stands in a result that nobody fills in."""
        return self.place_at(max(way.length, _moves.LONG_M) if self.at == ORIGIN else way.length, way.angle)

    def place_at(self, length: float, angle: float) -> ArenaPoint:
        """A place so far from the robot; for a server that rejects places in the arena, near the middle."""
        return place_inside(self.at, length, angle, 3.0 if "accepted" in self.lost else 0.0)


CHECKS = [
    endpoints_offered(title="The action /move_robot is there, with its type",
                      points=1.0, proves=["action", "only_a_class", "a_program", "start"]),
    node_name("move_robot_server", points=0.5, proves=["node"], after=["offered"]),
    *conversation(
        RobotModel,
        CheckPart("accepted", "A goal in the arena is accepted", points=1.0, proves=["reaches", "a_program"]),
        CheckPart("succeeds", "A goal in the arena ends SUCCEEDED, with a result",
                  points=2.0, proves=["reaches", "in_time"]),
        CheckPart("arrives", "The robot is at the target when the goal has succeeded",
                  points=2.0, proves=["reaches", "final_position", "position"]),
        CheckPart("distance", "distance_travelled is the length of the goal's own move, not of all moves",
                  points=1.0, proves=["distance_travelled"]),
        CheckPart("any_z", "The z of a target is ignored, whatever it is", points=1.0, proves=["any_z"]),
        CheckPart("already_there", "A goal at the present position succeeds at once",
                  points=1.0, proves=["already_there", "progress_limits"]),
        CheckPart("feedback", "During a move, feedback with the position comes at least five times per metre",
                  points=2.0, proves=["five_a_metre", "spread", "straight"]),
        CheckPart("progress", "Progress grows, the remaining distance shrinks, the position is on the straight line",
                  points=1.5, after=["feedback"],
                  proves=["straight", "position", "progress_limits", "monotonic", "distance_remaining"]),
        CheckPart("second_goal",
                  "While a goal runs, others are rejected; if two come at the same instant, only one is accepted",
                  points=1.5, proves=["second_goal", "same_instant"]),
        CheckPart("cancel", "A goal can be cancelled at any moment: it ends CANCELED within 1 s, before the target",
                  points=2.0, proves=["cancel_accepted", "cancelled", "one_thread", "position"]),
        CheckPart("after_cancel", "After a cancelled goal the next one works, and starts where the robot stopped",
                  points=1.0, proves=["after_cancel", "cancel_accepted"], after=["cancel"]),
        CheckPart("not_a_number", "Goals that are NaN or infinite are rejected", points=1.0, proves=["not_a_number"]),
        CheckPart("outside", "Goals outside the arena are rejected, goals on its edges are not",
                  points=1.5, proves=["edges_inside", "outside"]),
        steps=30, after=["offered"], deadline_s=120.0,
    ),
]  # fmt: skip

"""A goal as a check follows it, by what crosses the wire: accepted or rejected, its feedback, cancelled, its end."""

from __future__ import annotations

import os
import uuid
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalInfo, GoalStatus
from unique_identifier_msgs.msg import UUID

from course_kit.grading.checks import hangs
from course_kit.grading.checks.answers import are_same, describe_value, require_fields
from course_kit.grading.checks.context import ANSWER_S
from course_kit.grading.checks.evidence import GRADER, Evidence, Exchange, Failed, TimedStep, charge_to, in_one_line
from course_kit.grading.checks.hangs import RESEND_AFTER_S
from course_kit.grading.diagnosis import causes
from course_kit.ros.goal import status_name
from course_kit.ros.sequence import Arrow

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.grader_node import ReceivedFeedback
    from course_kit.grading.model.job import ProcessStatus
    from course_kit.ros.messages import ActionType, Message
    from course_kit.ros.service import SentRequest

SUCCEEDED, CANCELED, ABORTED = GoalStatus.STATUS_SUCCEEDED, GoalStatus.STATUS_CANCELED, GoalStatus.STATUS_ABORTED
END_S = 10.0
PROMPT_S = 1.0
_GOOD_PART = 0.4  # of the time of a goal, from the first to the last feedback
_TOO_LATE = 0.1  # of the time of a goal, before its end, for what tells of its middle
_QUIET_S = 0.025  # feedback is complete when none came for so long after the result, fairly counted
_REPAIRED_S = 3.5  # a message that got lost is sent again after the writer's next heartbeat, each 3 s in Fast DDS


def describe_end(ended: Message) -> str:
    """How a goal ended, by the response to the request for its result, as the learner is shown it."""
    return f"{status_name(ended.status)}, {in_one_line(ended.result)}"


class GradedGoal:
    """A goal; made, it is sent, and its `clock` begins. It is `shown` to the learner in words."""

    def __init__(self, context: CheckContext, action: str, interface: ActionType, message: Message) -> None:
        self.shown = f"a goal with {in_one_line(message)}"
        self._context, self._parts = context, interface.Impl
        self._line = context.grader_node.action(interface, action)
        self._stderr = context.program.stderr
        self._id = uuid.uuid4().bytes
        self._result: SentRequest | None = None
        self._all_heard = False
        self.clock = context.clock()
        request = self._parts.SendGoalService.Request(goal_id=self._uuid(), goal=message)
        self._turn = context.record.add_sent(f"goal for {action}: {in_one_line(message)}")
        self._turn.further_steps = self._feedback_steps
        self.feedback, self.statuses = self._line.follow(self._id)  # so far, oldest first
        self._answer = self._line.goals.send(request)

    @property
    def accepted(self) -> bool:
        """Whether it has said yes."""
        return self._answer.is_answered() and bool(self._answer.response().accepted)

    @property
    def over_at(self) -> float | None:
        """When the grader learned that it had ended, on the system's clock; None as long as it runs."""
        return next((when for when, status in self.statuses if status >= SUCCEEDED), None)

    @property
    def began_at(self) -> float:
        """When the grader first heard of it, on the system's clock; 0 if it never has."""
        return next((when for when, _ in self.statuses), 0.0)

    def accepted_by(
        self, *, expected: str = "the goal accepted", breaks: str = "", diagnosis: str = "validation.overzealous"
    ) -> GradedGoal:
        """The server accepts it.

        Args:
            expected: in words.
            breaks: the sentence of the exercise that is broken otherwise, where the check proves several.
            diagnosis: what it means that it was rejected.

        Raises:
            Failed: it rejects it, or does not answer.

        Example:
            >>> node.goal("/count_down", order=3).accepted_by()
        """
        if not self.wait_for_answer(expected):
            evidence = Evidence(self.shown, expected, "the goal rejected")
            raise Failed(evidence, "Your server rejected this goal, which is valid.", diagnosis, breaks=breaks)
        return self

    def rejected(
        self,
        *,
        what: str = "a goal that it has to reject",
        breaks: str = "",
        diagnosis: str = "action.accepts_impossible",
    ) -> None:
        """The server rejects it.

        Args:
            what: is wrong with the goal, for the learner.
            breaks: as in `accepted_by`.
            diagnosis: what it means that it was accepted.

        Raises:
            Failed: it accepts it, or does not answer.

        Example:
            >>> node.goal("/count_down", order=-1).rejected(what="a negative number")
        """
        if self.wait_for_answer("the goal rejected"):
            evidence = Evidence(self.shown, "the goal rejected", "the goal accepted")
            raise Failed(evidence, f"Your server accepted {what}.", diagnosis, breaks=breaks)

    def ends(
        self,
        status: str = "SUCCEEDED",
        *,
        within_s: float = END_S,
        not_before_s: float = 0.0,
        breaks: str = "",
        **fields: Any,
    ) -> Message:
        """It ends with this status, and a result with these fields.

        Args:
            status: SUCCEEDED, CANCELED or ABORTED.
            within_s: how long the end is waited for.
            not_before_s: seconds after the goal was sent before which it does not end, where the work takes its time.
            breaks: as in `accepted_by`.
            fields: of the result, as `Answer.expect` takes them.

        Raises:
            Failed: it ends otherwise, or not.

        Example:
            >>> node.goal("/count_down", order=2).accepted_by().ends(sequence=[2, 1])
        """
        expected = ", ".join(filter(None, (status, describe_value(fields))))
        with charge_to(breaks):
            ended = self.wait_for_end(within_s, expected)
            evidence = Evidence(self.shown, expected, describe_end(ended))
            went_on = status == "CANCELED" and ended.status == SUCCEEDED
            if went_on and causes.explain_goal_exception(self.process(), self._context.job) is None:
                why = "Your server agreed to cancel the goal, but went on to its end."
                raise Failed(evidence, why, "action.cancel_ignored")
            self.require_status(ended, getattr(GoalStatus, f"STATUS_{status}"), evidence)
            require_fields(fields, ended.result, "In the result, ", evidence)
            if (took_s := self.clock.wall_s()) < not_before_s:
                evidence = Evidence(self.shown, f"not before {not_before_s:g} s", f"it ended after {took_s:.2f} s")
                raise Failed(evidence, f"The goal ended before {not_before_s:g} s had passed.")
        return ended

    def expect_feedback(
        self, at_least: int = 1, *, first: dict[str, Any] | None = None, last: dict[str, Any] | None = None
    ) -> None:
        """Feedback came while it ran, not all at once; asked of a goal that has ended.

        Args:
            at_least: so many messages; from two on they have to be spread over the goal's time.
            first: fields of the first one.
            last: fields of the last one.

        Raises:
            Failed: it is not so; with action.no_feedback or action.late_feedback.

        Example:
            >>> goal.ends()
            >>> goal.expect_feedback(4, first={"sequence": [4]}, last={"sequence": [4, 3, 2, 1]})
        """
        heard = self.require_feedback(
            at_least,
            f"at least {at_least} feedback messages, spread over the goal's time",
            complete=lambda messages: are_same(last or {}, messages[-1].feedback),
        )
        for which, fields, message in (("first", first, heard[0].feedback), ("last", last, heard[-1].feedback)):
            expected = f"the {which} feedback with {describe_value(fields or {})}"
            evidence = Evidence(self.shown, expected, in_one_line(message))
            require_fields(fields or {}, message, f"In the {which} feedback, ", evidence)

    def cancelled(self, *, within_s: float = PROMPT_S, breaks: str = "") -> GradedGoal:
        """A request to cancel it is accepted in time; how it then ends is for `ends`.

        Args:
            within_s: how long the exercise gives the server for its answer.
            breaks: as in `accepted_by`.

        Raises:
            Failed: it is refused, with action.cancel_refused, or answered too late, with action.cancel_blocked.

        Example:
            >>> goal.cancelled().ends("CANCELED")
        """
        expected = f"cancelling accepted within {within_s:g} s, then CANCELED"
        clock, running = self._context.clock(), self.over_at is None
        turn, answer = self.cancel()
        evidence = Evidence(self.shown, expected)
        hangs.await_answer(self._context, answer.is_answered, evidence, ended=causes.explain_program)
        waited_s, late = clock.wall_s(), clock.has_passed(within_s)
        agreed = any(bytes(info.goal_id.uuid) == self._id for info in answer.response().goals_canceling)
        turn.add_received("cancelling accepted" if agreed else "cancelling refused")
        if agreed and not late:
            return self
        code: str | None
        if agreed:
            got, code = f"accepted after {waited_s:.1f} s", "action.cancel_blocked"
            why = f"Your server answered the request to cancel only after {waited_s:.1f} s."
        elif self.over_at is None:
            got, code = "cancelling refused", "action.cancel_refused"
            why = "Your server refused to cancel the goal, and the goal went on."
        else:
            got = f"an answer after {waited_s:.1f} s, when the goal was over ({status_name(self.statuses[-1][1])})"
            code = "action.cancel_blocked" if running and clock.has_passed(min(within_s, 0.3)) else None
            why = "The goal was over before the request to cancel arrived."
            if code:
                why = "Your server did not answer the request to cancel before the goal was over."
        raise Failed(replace(evidence, got=got), why, code, breaks=breaks)

    def wait_for_answer(self, expected: str, seconds: float = 0.0) -> bool:
        """Wait until the server has said yes or no; whether it has said yes."""
        hangs.await_answer(self._context, self._answer.is_answered, Evidence(self.shown, expected), seconds)
        self._turn.add_received("accepted" if self.accepted else "rejected")
        return self.accepted

    def wait_for_end(self, seconds: float, expected: str) -> Message:
        """Wait for the result."""
        result = self._result or self._line.results.send(self._parts.GetResultService.Request(goal_id=self._uuid()))
        self._result = result
        clock, evidence = self._context.clock(), Evidence(self.shown, expected)
        with hangs.explain_end(self._context, evidence, causes.explain_program, "no result: the program ended"):
            self._context.wait_until(lambda: result.is_answered(RESEND_AFTER_S if self.over_at else None), seconds)
        if result.is_answered():
            self._turn.add_received(f"result: {describe_end(result.response())}")
            return result.response()
        self._context.spoil()
        seconds = min(seconds, clock.fair_s())
        over = next((status_name(status) for _, status in self.statuses if status >= SUCCEEDED), "")
        look = partial(hangs.current_activity, self._context)
        diagnosis, message = causes.explain_silence(
            look, over, seconds, self.process(), self._context.program.asked_job
        )
        raise Failed(replace(evidence, got=f"no result within {seconds:.1f} s"), message, diagnosis)

    def wait_for_last_feedback(self, complete: Callable[[list[ReceivedFeedback]], bool]) -> list[ReceivedFeedback]:
        """The feedback of a goal that has ended, once no more comes."""
        if self._all_heard or complete(self.feedback):
            return self.feedback
        count, clock = -1, self._context.clock()

        def is_quiet() -> bool:
            nonlocal count, clock
            if count != len(self.feedback):
                count, clock = len(self.feedback), self._context.clock()
            return clock.has_passed(_QUIET_S) and (clock.has_passed(_REPAIRED_S) or complete(self.feedback))

        self._context.wait_until(is_quiet, ANSWER_S, step_s=_QUIET_S / 2)
        self._all_heard = complete(self.feedback)
        return self.feedback

    def require_feedback(
        self,
        at_least: int,
        expected: str,
        *,
        complete: Callable[[list[ReceivedFeedback]], bool] = lambda _: True,
        # The part of the work that a message says is left. Then one has to be of the middle third, of the time or of
        # the work: on a busy machine a message comes late.
        part_left: Callable[[Message], float] = lambda _: 0.5,  # whoever does not tell may be at the middle
    ) -> list[ReceivedFeedback]:
        """So many messages have come while it ran, not all at once."""
        heard = self.wait_for_last_feedback(lambda messages: len(messages) >= at_least and complete(messages))
        if len(heard) < at_least:
            count = f"{len(heard)} feedback message{'' if len(heard) == 1 else 's'}"
            raise Failed(Evidence(self.shown, expected, count), f"A client saw {count}.", "action.no_feedback")
        times = sorted(message.came_s for message in heard)  # one that got lost and was sent again is the latest
        began, over = self.began_at or times[0], self.over_at or times[-1]
        parts = [(message.came_s, part_left(message.feedback)) for message in heard if message.came_s <= over]
        if at_least > 1 and not is_spread(parts, began, over):
            sent_at = self._turn.steps[0][0]  # as the steps that are shown have it
            first, last = (f"{came_s - sent_at:.2f} s" for came_s in (times[0], times[-1]))
            came = f"all of them {first}" if first == last else f"{first} to {last}"
            got = f"{len(times)} messages, {came} after the goal was sent; it ended after {over - sent_at:.2f} s"
            evidence = Evidence(self.shown, expected, got)
            why = "The messages came in one burst, not spread over the goal's time."
            raise Failed(evidence, why, "action.late_feedback")
        return heard

    def cancel(self) -> tuple[Exchange, SentRequest]:
        """Ask the server to cancel it, by an action_msgs/srv/CancelGoal."""
        request = self._parts.CancelGoalService.Request(goal_info=GoalInfo(goal_id=self._uuid()))
        return self._context.record.add_sent("request to cancel the goal"), self._line.cancels.send(request)

    def process(self) -> ProcessStatus:
        """What is known of the program, with only what it has written to stderr since the goal was sent."""
        process = self._context.program.status()
        before = os.path.commonprefix([self._stderr, process.stderr])  # noqa: RUF071 - of long output the middle is cut
        return replace(process, stderr=process.stderr.removeprefix(before))

    def require_status(self, ended: Message, status: int, evidence: Evidence, breaks: str = "") -> None:
        """See that it has ended with a status, and without an exception."""
        if ended.status == status and ended.result != type(ended.result)():  # nothing has kept it from its end
            return
        if ended.status == status:
            evidence = replace(evidence, expected=f"{evidence.expected}, without an exception")
            cause = causes.explain_goal_exception(self.process(), self._context.job)
        else:
            cause = causes.explain_status(status_name(ended.status), self.process(), self._context.job)
        if cause is not None:
            raise Failed(evidence, cause[1], cause[0], breaks=breaks)

    def _feedback_steps(self) -> Iterator[TimedStep]:
        """The first and the last feedback."""
        heard, begin = self.feedback, self._turn.steps[0][0]
        for number in sorted({1, len(heard)} if heard else ()):
            message = heard[number - 1]
            text = f"feedback {number} after {message.came_s - begin:.2f} s: {in_one_line(message.feedback)}"
            yield message.came_s, Arrow(self._turn.partner, GRADER, "message", text)

    def _uuid(self) -> UUID:
        return UUID(uuid=list(self._id))


def is_spread(heard: Sequence[tuple[float, float]], began: float, over: float) -> bool:
    """Whether feedback, each with when it came and the part of the work that was left, took a good part of a goal."""
    if not heard:
        return False
    first, last, late = min(heard)[0], max(heard)[0], over - _TOO_LATE * (over - began)
    third = (last - first) / 3.0
    by_time = any(first + third <= time <= last - third for time, _ in heard)
    by_work = any(1 / 3 <= left <= 2 / 3 and time <= late for time, left in heard)
    return (by_time or by_work) and last - first >= _GOOD_PART * (over - began)

"""A goal as a check follows it: accepted or rejected, its feedback, cancelled, its end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.goals import CANCELED, SUCCEEDED, CheckedGoal, Ended
from course_kit.grading.checks.matching import describe_wanted, differences
from course_kit.grading.diagnosis import goals, hangs
from course_kit.grading.diagnosis.exceptions import explained
from course_kit.grading.exchange_log import in_one_line
from course_kit.ros.goal import status_name

if TYPE_CHECKING:
    from course_kit.grading.checks.actions import WantedAction
    from course_kit.grading.checks.context import CheckContext
    from course_kit.ros.messages import Message

END_S = 10.0
_STATUS = {"SUCCEEDED": SUCCEEDED, "CANCELED": CANCELED}
PROMPT_S = 1.0


class GradedGoal(CheckedGoal):
    """A goal that was sent."""

    def __init__(self, context: CheckContext, action: WantedAction, message: Message) -> None:
        super().__init__(context, action, message, f"a goal with {in_one_line(message)}")

    def accepted_by(self, *, expected: str = "the goal accepted", breaks: str = "") -> GradedGoal:
        """The server accepts it.

        Args:
            expected: in words.
            breaks: the sentence of the task that is broken otherwise, where the check proves several.

        Raises:
            Failed: it rejects it, with validation.overzealous, or does not answer.

        Example:
            >>> node.goal("/count_down", order=3).accepted_by()
        """
        self.wait_for_answer(expected)
        if not self.accepted:
            evidence = Evidence(self.shown, expected, "the goal rejected")
            raise Failed(
                evidence, "Your server rejected this goal, which is valid.", "validation.overzealous", breaks=breaks
            )
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
        self.wait_for_answer("the goal rejected")
        if self.accepted:
            evidence = Evidence(self.shown, "the goal rejected", "the goal accepted")
            raise Failed(evidence, f"Your server accepted {what}.", diagnosis, breaks=breaks)

    def ends(self, status: str = "SUCCEEDED", *, within_s: float = END_S, breaks: str = "", **fields: Any) -> Ended:
        """It ends with this status, and a result with these fields.

        Args:
            status: SUCCEEDED or CANCELED.
            within_s: how long the end is waited for.
            breaks: as in `accepted_by`.
            fields: of the result, as `Answer.expect` takes them.

        Raises:
            Failed: it ends otherwise, or not.

        Example:
            >>> node.goal("/count_down", order=2).accepted_by().ends(sequence=[2, 1])
        """
        expected = ", ".join(filter(None, (status, describe_wanted(fields))))
        try:
            ended = self.wait_for_end(within_s, expected)
            evidence = Evidence(self.shown, expected, f"{ended.name}, {in_one_line(ended.result)}")
            if status == "CANCELED" and ended.status == SUCCEEDED and self._nothing_raised():
                why = "Your server agreed to cancel the goal, but went on to its end."
                raise Failed(evidence, why, "action.cancel_ignored")  # noqa: TRY301 - the sentence is added below
            self.require_status(ended, _STATUS[status], evidence)
        except Failed as failed:
            failed.breaks = failed.breaks or breaks
            raise
        for path, wanted, got in differences(fields, ended.result):
            why = f"{path} of the result has to be {describe_wanted(wanted)}, and is {got!r}."
            raise Failed(evidence, why, breaks=breaks)
        return ended

    def cancelled(self, *, within_s: float = PROMPT_S, breaks: str = "") -> GradedGoal:
        """A request to cancel it is accepted in time; how it then ends is for `ends`.

        Args:
            within_s: how long the task gives the server for its answer.
            breaks: as in `accepted_by`.

        Raises:
            Failed: it is refused, with action.cancel_refused, or answered too late, with action.cancel_blocked.

        Example:
            >>> goal.cancelled().ends("CANCELED")
        """
        expected = f"cancelling accepted within {within_s:g} s, then CANCELED"
        clock, running = self._context.clock(), self.over_at is None
        answer = self.cancel()
        evidence = Evidence(self.shown, expected)
        with explained(self._context, evidence, goals.of_program, "no answer: the program ended"):
            self._context.wait_until(answer.answered, hangs.ANSWER_S)
        if not answer.answered():
            raise hangs.unanswered(self._context, self.shown, expected, clock.fair())
        waited_s, late = clock.wall(), clock.past(within_s)
        agreed = self.is_cancelled_by(answer.response())
        if agreed and late:
            why = f"Your server answered the request to cancel only after {waited_s:.1f} s."
            raise Failed(
                Evidence(self.shown, expected, f"accepted after {waited_s:.1f} s"),
                why,
                "action.cancel_blocked",
                breaks=breaks,
            )
        if not agreed and self.over_at is None:
            why = "Your server refused to cancel the goal, and the goal went on."
            raise Failed(
                Evidence(self.shown, expected, "cancelling refused"), why, "action.cancel_refused", breaks=breaks
            )
        if not agreed:
            got = f"an answer after {waited_s:.1f} s, when the goal was over ({status_name(self.statuses[-1][1])})"
            evidence = Evidence(self.shown, expected, got)
            if running and clock.past(min(within_s, 0.3)):
                why = "Your server did not answer the request to cancel before the goal was over."
                raise Failed(evidence, why, "action.cancel_blocked", breaks=breaks)
            raise Failed(evidence, "The goal was over before the request to cancel arrived.", breaks=breaks)
        return self

    def _nothing_raised(self) -> bool:
        return goals.of_exception(self.process(), self._context.job) is None

"""Declared checks of a goal while it runs: its feedback, and that it can be cancelled."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.declared.around import made
from course_kit.grading.checks.declared.explaining import Exchanged, explained
from course_kit.grading.checks.declared.goals import send, succeed, wait_for_acceptance
from course_kit.grading.checks.declared.messages import Tolerance, differences, plain, shown, shown_part, worked_out
from course_kit.grading.checks.declared.wanted import action_of
from course_kit.grading.checks.discovery import ENDED
from course_kit.grading.checks.goals import CANCELED, SUCCEEDED, CheckedGoal, Ended
from course_kit.grading.diagnosis import goals, hangs
from course_kit.grading.diagnosis.exceptions import explained as explained_end

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.checks.actions import ReceivedFeedback
    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.declared.around import Around
    from course_kit.grading.checks.declared.declaration import Declaration

_PROMPT_S = 1.0  # within which a request to cancel is answered, unless the check says otherwise
_AT_ONCE_S = 0.3  # a request that waited for longer, of a goal that ran when it was sent, was kept waiting
_UNDER_WAY_S = 0.3  # when a goal is cancelled that gives no feedback
_ROUNDING = 1e-6
_GOOD_PART = 0.4  # of a goal's time, over which feedback that is spread comes


def goal_feedback(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """Each goal comes with the feedback that is expected.

    Raises:
        Failed: with too little, with another, or all at once.
    """
    evidence = Evidence()
    for case in around.cases(check, context.job.seed):
        goal = send(context, check, case.fields)
        wait_for_acceptance(context, check, goal, None)
        succeed(context, check, goal, {})
        message = plain(made(action_of(check.endpoints["action"]).interface.Goal, case.fields, "the goal"))
        evidence = _require_feedback(check, goal, message)
    return evidence


def _require_feedback(check: Declaration, goal: CheckedGoal, message: Any) -> Evidence:
    least, tolerance = int(check.keys.get("at_least", 1)), Tolerance.of(check.keys.get("tolerance"))

    def fits(one: ReceivedFeedback, key: str) -> bool:
        wanted = worked_out(check.keys[key], {"goal": message, "feedback": plain(one.feedback)})
        return next(differences(wanted, plain(one.feedback), tolerance), None) is None

    def complete(all_told: list[ReceivedFeedback]) -> bool:
        return len(all_told) >= least and ("last" not in check.keys or fits(all_told[-1], "last"))

    heard = goal.wait_for_last_feedback(complete)
    messages = f"{least} feedback message{'s' * (least > 1)}"
    evidence = Evidence(goal.shown, f"at least {messages}", f"{len(heard)} feedback message{'s' * (len(heard) != 1)}")
    if len(heard) < least:
        raise Failed(evidence, f"A client saw {evidence.got} of this goal.", "action.no_feedback")
    if check.keys.get("spread"):
        _require_spread(goal, heard, evidence)
    for key, direction in (("rising", 1), ("falling", -1)):
        for path in check.keys.get(key, ()):
            _require_direction(goal, heard, path, direction)
    places: list[tuple[str, Sequence[ReceivedFeedback]]] = [("first", heard[:1]), ("each", heard), ("last", heard[-1:])]
    for key, some in places:
        for one in some if key in check.keys else ():
            if not fits(one, key):
                wanted = worked_out(check.keys[key], {"goal": message, "feedback": plain(one.feedback)})
                raise _wrong(goal, key, wanted, plain(one.feedback), tolerance)
    return evidence


def _require_spread(goal: CheckedGoal, heard: Sequence[ReceivedFeedback], evidence: Evidence) -> None:
    """It came while the goal ran, not all at once."""
    times = sorted(one.came_s for one in heard)  # one that got lost and was sent again is the latest
    began, over = goal.began_at or times[0], goal.over_at or times[-1]
    told = f"{len(times)} messages, {times[0] - began:.2f} s to {times[-1] - began:.2f} s after the start"
    within = [time for time in times if time <= over]
    if not within or within[-1] - within[0] < _GOOD_PART * (over - began):
        expected = f"{evidence.expected}, spread over the goal's time"
        evidence = replace(evidence, expected=expected, got=f"{told}; the goal ended after {over - began:.2f} s")
        raise Failed(evidence, "The messages came in one burst, not while the goal ran.", "action.late_feedback")


def _require_direction(goal: CheckedGoal, heard: Sequence[ReceivedFeedback], path: str, direction: int) -> None:
    for before, after in itertools.pairwise(_at(one.feedback, path) for one in heard):
        if not direction * (after - before) >= -_ROUNDING:
            verb, wrong = ("grow", "falls") if direction > 0 else ("shrink", "grows")
            got = f"{path}={before:.10g}, then {after:.10g}"
            message = f"Two messages of one goal contradict each other: {path} {wrong}."
            raise Failed(
                Evidence(goal.shown, f"{path} to {verb} or stay", got), message, "action.feedback_not_monotonic"
            )


def _at(message: Any, path: str) -> float:
    for name in path.split("."):
        message = getattr(message, name)
    return float(message)


def _wrong(goal: CheckedGoal, key: str, wanted: Any, got: Any, tolerance: Tolerance) -> Failed:
    which = {"first": "the first feedback", "each": "each feedback", "last": "the last feedback"}[key]
    path, value, came = next(differences(wanted, got, tolerance))
    evidence = Evidence(goal.shown, f"{which} with {shown_part(wanted)}", shown_part(got, wanted))
    what = f"{path}={came!r}" if path else repr(came)
    verb = "has to say" if key != "each" else "has to follow from the goal and the rest of the message:"
    return Failed(evidence, f"{which[0].upper()}{which[1:]} {verb} {value!r}, but one said {what}.")


def goal_cancelled(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """A goal that runs is cancelled: that is accepted at once, it ends CANCELED, and the next goal works.

    Raises:
        Failed: it is not; with action.cancel_refused, action.cancel_ignored, action.cancel_blocked and others.
    """
    evidence = Evidence()
    try:
        for case in around.cases(check, context.job.seed):
            goal = send(context, check, case.fields)
            wait_for_acceptance(context, check, goal, None)
            evidence = _cancelled(context, check, goal, case.fields)
    except Failed:
        context.spoil()
        raise
    if "then" in check.keys:
        after = send(context, check, check.keys["then"])
        after.wait_for_answer("the goal after it accepted")
        if not after.accepted:
            evidence = Evidence(f"after the cancelled goal, {after.shown}", "the goal accepted", "the goal rejected")
            message = "No goal was running any more, but your server rejected the next one."
            raise Failed(evidence, message, "validation.overzealous")
        succeed(context, check, after, {})
    return evidence


def _cancelled(context: CheckContext, check: Declaration, goal: CheckedGoal, fields: dict[str, Any]) -> Evidence:
    prompt_s = float(check.keys.get("within_s", _PROMPT_S))
    expected = f"cancelling accepted within {prompt_s:g} s, then CANCELED"
    _get_under_way(context, check, goal, expected)
    _have_it_accepted(context, goal, prompt_s, expected)
    ended = goal.wait_for_end(hangs.ANSWER_S, expected)
    evidence = Evidence(
        f"{goal.shown}, then a request to cancel", expected, f"{ended.name}, {shown(plain(ended.result))}"
    )
    _require_canceled(context, goal, ended, evidence)
    if "expect" not in check.keys:
        return evidence
    message = plain(made(action_of(check.endpoints["action"]).interface.Goal, fields, "the goal"))
    wanted = worked_out(check.keys["expect"], {"goal": message})
    tolerance = Tolerance.of(check.keys.get("tolerance"))
    evidence = replace(evidence, expected=f"{expected}, {shown_part(wanted)}")
    if next(differences(wanted, plain(ended.result), tolerance), None) is not None:
        one = Exchanged(message, wanted, ended.result)
        diagnosis, text = explained(one, [one], tolerance, floors=context.job.facts.floor_divides)
        raise Failed(evidence, text, diagnosis)
    return evidence


def _get_under_way(context: CheckContext, check: Declaration, goal: CheckedGoal, expected: str) -> None:
    """Wait until a goal runs: as feedback tells, or long enough for one that says nothing."""
    after_s = check.keys.get("after_s")

    def under_way() -> bool:
        if goal.over_at is not None:
            return True
        return goal.clock.past(_UNDER_WAY_S if after_s is None else after_s) or (
            after_s is None and bool(goal.feedback)
        )

    with explained_end(context, Evidence(goal.shown, expected), goals.of_program, ENDED):
        context.wait_until(under_way, hangs.ANSWER_S)


def _have_it_accepted(context: CheckContext, goal: CheckedGoal, prompt_s: float, expected: str) -> None:
    clock, running = context.clock(), goal.over_at is None
    answer = goal.cancel()
    with explained_end(context, Evidence(goal.shown, expected), goals.of_program, "no answer: the program ended"):
        context.wait_until(answer.answered, hangs.ANSWER_S)
    if not answer.answered():
        raise hangs.unanswered(context, goal.shown, expected, clock.fair())
    waited_s, late = clock.wall(), clock.past(prompt_s)
    if goal.is_cancelled_by(answer.response()):
        if late:
            evidence = Evidence(goal.shown, expected, f"accepted after {waited_s:.1f} s")
            message = f"Your server answered the request to cancel only after {waited_s:.1f} s."
            raise Failed(evidence, message, "action.cancel_blocked")
        return
    if goal.over_at is None:
        message = "Your server refused to cancel the goal, and the goal went on."
        raise Failed(Evidence(goal.shown, expected, "cancelling refused"), message, "action.cancel_refused")
    evidence = Evidence(goal.shown, expected, f"an answer after {waited_s:.1f} s, when the goal was over")
    if running and clock.past(min(prompt_s, _AT_ONCE_S)):
        message = "Your server did not answer the request to cancel before the goal was over."
        raise Failed(evidence, message, "action.cancel_blocked")
    raise Failed(evidence, "The goal was over before the request to cancel arrived.")


def _require_canceled(context: CheckContext, goal: CheckedGoal, ended: Ended, evidence: Evidence) -> None:
    if ended.status == SUCCEEDED and goals.of_exception(goal.process(), context.job) is None:
        message = "Your server agreed to cancel the goal, but went on to its end."
        raise Failed(evidence, message, "action.cancel_ignored")
    goal.require_status(ended, CANCELED, evidence)

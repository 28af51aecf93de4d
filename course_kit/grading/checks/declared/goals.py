"""Declared checks of an action: its goals succeed, or are rejected. Feedback and cancelling are in `under_way`."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.declared.around import made
from course_kit.grading.checks.declared.explaining import Exchanged, explained
from course_kit.grading.checks.declared.messages import (
    Tolerance,
    differences,
    in_words,
    plain,
    shown,
    shown_part,
    worked_out,
)
from course_kit.grading.checks.declared.services import require_not_before
from course_kit.grading.checks.declared.starting import ensure_up
from course_kit.grading.checks.declared.wanted import action_of
from course_kit.grading.checks.goals import SUCCEEDED, CheckedGoal, Ended

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.declared.around import Around
    from course_kit.grading.checks.declared.declaration import Declaration
    from course_kit.grading.plain_data import Record

_TO_BE_REJECTED = "a goal that it has to reject"
_ACCEPTED, _REJECTED = "the goal accepted", "the goal rejected"
_END_S = 10.0  # within which a goal ends, unless the check says otherwise
REACHED = "SUCCEEDED"


def goal_succeeds(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """Each goal is accepted and ends SUCCEEDED, with the result that is expected.

    Raises:
        Failed: one is rejected, ends otherwise, or has another result.
    """
    tolerance, exchanges = Tolerance.of(check.keys.get("tolerance")), []
    cases = around.cases(check, context.job.seed)
    for number, case in enumerate(cases):
        began = time.monotonic()
        goal = send(context, check, case.fields)
        wait_for_acceptance(context, check, goal, [one.fields for one in cases[number + 1 :]] if number == 0 else None)
        message = plain(made(_goal_type(check), case.fields, "the goal"))
        expected = {} if case.expected is None else case.expected
        wanted = worked_out(expected, {"goal": message, **around.oracle(check, number)})
        ended = succeed(context, check, goal, wanted)
        require_not_before(check, time.monotonic() - began, Evidence(goal.shown, REACHED))
        exchanges.append(Exchanged(message, wanted, ended.result))
    for one in exchanges:
        if next(differences(one.wanted, plain(one.got), tolerance), None) is not None:
            diagnosis, text = explained(one, exchanges, tolerance, floors=context.job.facts.floor_divides)
            raise Failed(_evidence(one), text, diagnosis)
    return _evidence(exchanges[-1])


def goal_refused(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """Each goal is rejected, or each while another runs.

    Raises:
        Failed: one is accepted, with action.accepts_impossible or action.concurrent_goals.
    """
    running = check.keys.get("while_running")
    first = None
    if running is not None:
        first = send(context, check, running)
        wait_for_acceptance(context, check, first, None)
    evidence = Evidence()
    for case in around.cases(check, context.job.seed):
        goal = send(context, check, case.fields)
        goal.wait_for_answer(_REJECTED)
        sent = goal.shown if first is None else f"{first.shown}; while it runs, {goal.shown}"
        evidence = Evidence(sent, _REJECTED, _ACCEPTED if goal.accepted else _REJECTED)
        if goal.accepted:
            context.spoil()
            what = in_words(check, _TO_BE_REJECTED, goal=plain(made(_goal_type(check), case.fields, "the goal")))
            raise _accepted(first, evidence, what)
    if first is not None:
        succeed(context, check, first, {})
    return evidence


def _accepted(first: CheckedGoal | None, evidence: Evidence, what: str) -> Failed:
    if first is None:
        return Failed(evidence, f"Your server accepted {what}.", "action.accepts_impossible")
    if first.over_at is not None:
        message = "The first goal was over before the second arrived: it has to run while the second is sent."
        return Failed(evidence, message)
    message = "Your server accepted a second goal while the first was running."
    return Failed(evidence, message, "action.concurrent_goals")


def send(context: CheckContext, check: Declaration, fields: Record) -> CheckedGoal:
    """Send a goal with these fields."""
    ensure_up(context, check.endpoints)
    message = made(_goal_type(check), fields, "the goal")
    return CheckedGoal(context, action_of(check.endpoints["action"]), message, f"a goal with {shown(plain(message))}")


def wait_for_acceptance(
    context: CheckContext, check: Declaration, goal: CheckedGoal, others: Sequence[Record] | None
) -> None:
    """Wait until a goal is accepted.

    Args:
        context: the check's.
        check: whose goals these are.
        goal: the first, or one after others that were accepted.
        others: for the first: goals to try when it is rejected; None for one after it.

    Raises:
        Failed: it is rejected, with validation.overzealous, or action.rejects_all when the others are, too.
    """
    goal.wait_for_answer(_ACCEPTED)
    if goal.accepted:
        return
    evidence = Evidence(goal.shown, _ACCEPTED, _REJECTED)
    context.spoil()
    if others is None:
        raise Failed(evidence, "Your server rejected this goal, which is valid.", "validation.overzealous")
    for fields in others:
        again = send(context, check, fields)
        again.wait_for_answer(_ACCEPTED)
        context.spoil()
        if again.accepted:
            message = f"This goal is valid, and so is {again.shown}, which your server accepted."
            raise Failed(evidence, message, "validation.overzealous")
    message = f"Each of {len(others) + 1} valid goals was rejected." if others else "A valid goal was rejected."
    raise Failed(evidence, message, "action.rejects_all")


def succeed(context: CheckContext, check: Declaration, goal: CheckedGoal, wanted: Any) -> Ended:
    """Wait until an accepted goal has ended, SUCCEEDED.

    Args:
        context: the check's.
        check: whose goal it is.
        goal: the goal.
        wanted: what its result is to hold.

    Raises:
        Failed: it has not, or otherwise; with action.no_terminal, action.wrong_terminal and others.
    """
    expected = f"{REACHED}, {shown_part(wanted)}" if wanted else REACHED
    ended = goal.wait_for_end(float(check.keys.get("within_s", _END_S)), expected)
    try:
        evidence = Evidence(goal.shown, expected, f"{ended.name}, {shown(plain(ended.result))}")
        goal.require_status(ended, SUCCEEDED, evidence)
    except Failed:
        context.spoil()
        raise
    return ended


def ask(context: CheckContext, check: Declaration, around: Around) -> list[Any]:
    """The results that the solution, which runs now, gives for the goals of a check."""
    found = []
    for case in around.cases(check, context.job.seed):
        goal = send(context, check, case.fields)
        wait_for_acceptance(context, check, goal, None)
        found.append(plain(succeed(context, check, goal, {}).result))
    return found


def _goal_type(check: Declaration) -> Any:
    return action_of(check.endpoints["action"]).interface.Goal


def _evidence(one: Exchanged) -> Evidence:
    wanted = f"{REACHED}, {shown_part(one.wanted)}" if one.wanted else REACHED
    return Evidence(f"a goal with {shown(one.sent)}", wanted, f"{REACHED}, {shown(plain(one.got))}")

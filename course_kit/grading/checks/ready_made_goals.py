"""Ready-made checks of actions: functions that return a check, made of the verbs of `GradedGoal`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.graded_goal import END_S, PROMPT_S
from course_kit.grading.checks.ready_made import make_check
from course_kit.grading.checks.steps import draw_values

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from typing_extensions import Unpack

    from course_kit.grading.checks.check import Check
    from course_kit.grading.checks.graded_node import GradedNode
    from course_kit.grading.checks.ready_made import CheckFields

_DEADLINE_S = 30.0
_ACCEPTED = "the goal accepted"


def goal_succeeds(
    action: str,
    goals: Sequence[dict[str, Any]],
    expect: Callable[[Any], dict[str, Any]] = lambda _: {},
    *,
    within_s: float = END_S,
    not_before_s: float = 0.0,
    **declared: Unpack[CheckFields],
) -> Check:
    """A check that goals are accepted and end SUCCEEDED, with a result.

    Args:
        action: its name.
        goals: fields of each; a value may be a drawing.
        expect: gives the fields of the right result for a goal.
        within_s: seconds for each goal.
        not_before_s: seconds before which none ends, where the work takes its time.
        declared: see `CheckFields`.

    Example:
        >>> goal_succeeds("/count_down", [{"order": 3}], lambda goal: {"sequence": list(range(goal.order, 0, -1))},
        ...               check_id="counts", title="A goal counts down", points=1.0, proves=["counts"])
    """

    def talk(node: GradedNode) -> None:
        several = draw_values(goals, node.context.random)
        for fields in several:
            wanted, goal = expect(node.message_for(action, fields)), node.goal(action, fields)
            none_yet = fields is several[0] and not goal.wait_for_answer(_ACCEPTED)
            if none_yet and not any(node.goal(action, other).wait_for_answer(_ACCEPTED) for other in several):
                goal.accepted_by(diagnosis="action.rejects_all")
            goal.accepted_by().ends(within_s=within_s, not_before_s=not_before_s, **wanted)

    return make_check(talk, _DEADLINE_S, **declared)


def goal_feedback(
    action: str,
    goals: Sequence[dict[str, Any]],
    *,
    at_least: int = 1,
    first: Callable[[Any], dict[str, Any]] = lambda _: {},
    last: Callable[[Any], dict[str, Any]] = lambda _: {},
    **declared: Unpack[CheckFields],
) -> Check:
    """A check that feedback comes while goals run, not all of it at once.

    Args:
        action: its name.
        goals: fields of each; a value may be a drawing.
        at_least: so many messages for each goal; from two on they have to be spread over its time.
        first: gives the fields of the first message for a goal.
        last: gives those of the last one.
        declared: see `CheckFields`.

    Example:
        >>> goal_feedback("/count_down", [{"order": 4}], at_least=4, first=lambda goal: {"sequence": [goal.order]},
        ...               check_id="feedback", title="Each number is published", points=1.0, proves=["in_steps"])
    """

    def talk(node: GradedNode) -> None:
        for fields in draw_values(goals, node.context.random):
            message = node.message_for(action, fields)
            goal = node.goal(action, fields).accepted_by()
            goal.ends()
            goal.expect_feedback(at_least, first=first(message), last=last(message))

    return make_check(talk, _DEADLINE_S, **declared)


def goal_refused(
    action: str,
    goals: Sequence[dict[str, Any]],
    *,
    what: str = "",
    while_running: dict[str, Any] | None = None,
    **declared: Unpack[CheckFields],
) -> Check:
    """A check that goals are rejected, or rejected while another one runs.

    Args:
        action: its name.
        goals: fields of each; a value may be a drawing.
        what: is wrong with these goals, for the learner.
        while_running: a goal that is sent before, runs meanwhile, and succeeds all the same.
        declared: see `CheckFields`.

    Example:
        >>> goal_refused("/count_down", [{"order": draw_between(-9, -1)}], what="a negative number",
        ...              check_id="refused", title="A negative order is rejected", points=1.0, proves=["refused"])
    """

    def talk(node: GradedNode) -> None:
        running = node.goal(action, while_running).accepted_by() if while_running is not None else None
        wrong, code = "a goal that it has to reject", "action.accepts_impossible"
        if running is not None:
            wrong, code = "a second goal while the first was running", "action.concurrent_goals"
        for fields in draw_values(goals, node.context.random):
            node.goal(action, fields).rejected(what=what or wrong, diagnosis=code)
        if running is not None:
            running.ends()

    return make_check(talk, _DEADLINE_S, **declared)


def goal_cancelled(  # noqa: PLR0913 - what an author may say of it
    action: str,
    goals: Sequence[dict[str, Any]],
    expect: Callable[[Any], dict[str, Any]] = lambda _: {},
    *,
    after_s: float = 0.3,
    within_s: float = PROMPT_S,
    then: dict[str, Any] | None = None,
    **declared: Unpack[CheckFields],
) -> Check:
    """A check that a goal that runs can be cancelled: that is accepted in time, and it ends CANCELED.

    Args:
        action: its name.
        goals: fields of each; a value may be a drawing.
        expect: gives the fields of the result for a goal.
        after_s: seconds after which the cancel is sent.
        within_s: seconds for the answer to the request to cancel.
        then: a goal that succeeds afterwards.
        declared: see `CheckFields`.

    Example:
        >>> goal_cancelled("/count_down", [{"order": 20}], then={"order": 2}, check_id="cancel",
        ...                title="A goal can be cancelled", points=1.0, proves=["cancel"])
    """

    def talk(node: GradedNode) -> None:
        for fields in draw_values(goals, node.context.random):
            goal = node.goal(action, fields).accepted_by()
            node.wait(after_s)
            goal.cancelled(within_s=within_s).ends("CANCELED", **expect(node.message_for(action, fields)))
        if then is not None:
            node.goal(action, then).accepted_by(expected="the goal after a cancelled one accepted").ends()

    return make_check(talk, _DEADLINE_S, **declared)

"""Ready-made checks of actions: functions that return a check."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.answers import TOO_SOON, describe_wanted, differences
from course_kit.grading.checks.check import Check, Evidence, Failed
from course_kit.grading.checks.exchange_log import in_one_line
from course_kit.grading.checks.graded_goal import END_S, PROMPT_S, GradedGoal
from course_kit.grading.checks.ready_made import make_check
from course_kit.grading.checks.steps import draw_values

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from typing_extensions import Unpack

    from course_kit.grading.checks.graded_node import GradedNode
    from course_kit.grading.checks.ready_made import CheckFields

_DEADLINE_S = 30.0
_UNDER_WAY_S = 0.3  # after which a goal is cancelled that gives no feedback


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
        for number, fields in enumerate(several):
            clock = node.context.clock()  # before the goal: the node may begin while we still wait for our turn
            goal = node.goal(action, fields)
            if number == 0:
                _require_some_accepted(node, action, goal, several[1:])
            goal.accepted_by().ends(within_s=within_s, **expect(node.message_for(action, fields)))
            if clock.wall() < not_before_s:
                got = f"it ended after {clock.wall():.2f} s"
                raise Failed(Evidence(goal.shown, f"not before {not_before_s:g} s", got), TOO_SOON)

    return _make_check(talk, **declared)


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
        ...               check_id="feedback", title="Each number is told", points=1.0, proves=["in_steps"])
    """

    def talk(node: GradedNode) -> None:
        for fields in draw_values(goals, node.context.random):
            message = node.message_for(action, fields)
            wanted = first(message), last(message)
            goal = node.goal(action, fields).accepted_by()
            goal.ends()
            heard = goal.require_feedback(
                at_least,
                f"at least {at_least} feedback messages, spread over the goal's time",
                complete=lambda messages, end=wanted[1]: not list(differences(end, messages[-1].feedback)),  # type: ignore[misc] # of one argument
            )
            for which, fields_of, one in zip(("first", "last"), wanted, (heard[0], heard[-1]), strict=True):
                for path, value, got in differences(fields_of, one.feedback):
                    expected = f"the {which} feedback with {describe_wanted(fields_of)}"
                    evidence = Evidence(goal.shown, expected, in_one_line(one.feedback))
                    raise Failed(evidence, f"{path} of the {which} feedback has to be {value!r}, and is {got!r}.")

    return _make_check(talk, **declared)


def goal_refused(
    action: str,
    goals: Sequence[dict[str, Any]],
    *,
    what: str = "a goal that it has to reject",
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
        for fields in draw_values(goals, node.context.random):
            goal = node.goal(action, fields)
            if running is None:
                goal.rejected(what=what)
                continue
            goal.wait_for_answer("the goal rejected")
            if goal.accepted:
                sent = f"{running.shown}; while it runs, {goal.shown}"
                evidence = Evidence(sent, "the goal rejected", "the goal accepted")
                if running.over_at is not None:
                    raise Failed(evidence, "The first goal was over before the second arrived.")
                why = "Your server accepted a second goal while the first was running."
                raise Failed(evidence, why, "action.concurrent_goals")
        if running is not None:
            running.ends()

    return _make_check(talk, **declared)


def goal_cancelled(  # noqa: PLR0913 - what an author may say of it
    action: str,
    goals: Sequence[dict[str, Any]],
    expect: Callable[[Any], dict[str, Any]] = lambda _: {},
    *,
    after_s: float | None = None,
    within_s: float = PROMPT_S,
    then: dict[str, Any] | None = None,
    **declared: Unpack[CheckFields],
) -> Check:
    """A check that a goal that runs can be cancelled: that is accepted in time, and it ends CANCELED.

    Args:
        action: its name.
        goals: fields of each; a value may be a drawing.
        expect: gives the fields of the result for a goal.
        after_s: when the cancel is sent; with the first feedback, or after 0.3 s, when left out.
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
            node.context.wait_until(lambda goal=goal: _under_way(goal, after_s), END_S)  # type: ignore[misc] # of none
            goal.cancelled(within_s=within_s).ends("CANCELED", **expect(node.message_for(action, fields)))
        if then is not None:
            node.goal(action, then).accepted_by(expected="the goal after a cancelled one accepted").ends()

    return _make_check(talk, **declared)


def _make_check(talk: Callable[[GradedNode], object], **declared: Unpack[CheckFields]) -> Check:
    """A check after whose failure the program is started afresh: a goal may still run."""
    declared.setdefault("deadline_s", _DEADLINE_S)
    declared.setdefault("afresh", True)
    return make_check(talk, **declared)


def _require_some_accepted(node: GradedNode, action: str, goal: GradedGoal, others: Sequence[dict[str, Any]]) -> None:
    """Of the first goal, or of one of the others, the server says that it accepts it."""
    goal.wait_for_answer("the goal accepted")
    if goal.accepted or not others:
        return
    for fields in others:
        other = node.goal(action, fields)
        other.wait_for_answer("the goal accepted")
        if other.accepted:
            return
    evidence = Evidence(goal.shown, "the goal accepted", "the goal rejected")
    raise Failed(evidence, f"Each of {len(others) + 1} valid goals was rejected.", "action.rejects_all")


def _under_way(goal: GradedGoal, after_s: float | None) -> bool:
    if goal.over_at is not None:
        return True
    return goal.clock.past(_UNDER_WAY_S if after_s is None else after_s) or (after_s is None and bool(goal.feedback))

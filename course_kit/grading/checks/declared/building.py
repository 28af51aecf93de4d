"""Makes a `Check` of each declaration, in the grader process."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.checks.check import Check
from course_kit.grading.checks.declared import acting, goals, parameters, services, starting, topics, under_way
from course_kit.grading.checks.declared.around import Around, interface_of
from course_kit.grading.checks.declared.declaration import Declaration

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.grading.checks.check import Evidence
    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.plain_data import Record

_RUN: dict[str, Callable[[CheckContext, Declaration, Around], Evidence]] = {
    "offered": starting.offered,
    "node_name": starting.node_name,
    "answers": services.answers,
    "refuses": services.refuses,
    "topic_answers": topics.topic_answers,
    "parameter_declared": parameters.parameter_declared,
    "parameter_acts": acting.parameter_acts,
    "parameter_refuses": parameters.parameter_refuses,
    "goal_succeeds": goals.goal_succeeds,
    "goal_feedback": under_way.goal_feedback,
    "goal_refused": goals.goal_refused,
    "goal_cancelled": under_way.goal_cancelled,
}


def around_of(records: Sequence[Record]) -> Around:
    """The declared checks that a job carries."""
    return Around([Declaration.from_record(record) for record in records])


def checks_of(around: Around) -> list[Check]:
    """A check for each declaration, in their order."""
    return [_check(one, around) for one in around.declarations]


def interfaces_of(declarations: Sequence[Declaration]) -> list[type]:
    """The classes of the interfaces that declared checks use."""
    names = {endpoint.type for one in declarations for endpoint in one.endpoints.values()}
    return [interface_of(name) for name in sorted(names)]


def _check(declaration: Declaration, around: Around) -> Check:
    def run(context: CheckContext) -> Evidence:
        return _RUN[declaration.kind](context, declaration, around)

    one = declaration
    return Check(one.id, one.title, one.points, one.depends_on, one.deadline_s, run, one.proves)

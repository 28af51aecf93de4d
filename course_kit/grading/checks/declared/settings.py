"""A node's parameters as declared checks use them: met, set, and put back to what they were."""

from __future__ import annotations

from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.declared.messages import parameters_in
from course_kit.grading.checks.parameters import Remote, ensure_served, expect_served, require_proper_answer, shown
from course_kit.ros.parameters import NOT_SET

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.parameters import Value

_MET = "declared parameters of "  # what is remembered of the running submission


def served(context: CheckContext, node: str) -> Remote:
    """The parameters of a node that is up.

    Raises:
        Failed: it is not; as `expect_served`.
    """
    if context.spoiled:
        return ensure_served(context, node)
    if (_MET + node) not in context.memory:
        expect_served(context, node)
        context.memory[_MET + node] = True
    return Remote(context, node)


@contextmanager
def put_back(context: CheckContext, remote: Remote, names: Iterable[str]) -> Iterator[Mapping[str, Value]]:
    """The present values of some parameters, to which they are put back afterwards."""
    found = remote.values(list(names))
    before = {name: one.value for name, one in found.items() if one.type != NOT_SET}
    try:
        yield found
    finally:
        if remote.changed and before and not context.spoiled:
            # What is wrong with it was or will be said by the checks themselves.
            with suppress(Failed), context.record.looking_away(), context.after_the_verdict():
                remote.set_together(before)


def accept(remote: Remote, values: Mapping[str, Any]) -> None:
    """Set valid values, one after the other, and see that they are in force.

    Raises:
        Failed: one is refused, or has another value afterwards; with validation.overzealous or parameter.*.
    """
    for name, value in values.items():
        outcome = remote.set(name, value)
        if not outcome.successful:
            evidence = Evidence(shown({name: value}), "accepted: the value is valid", outcome.shown())
            require_proper_answer(outcome, evidence)
            if remote.values([name])[name].type == NOT_SET:
                raise Failed(evidence, f"Your node has not declared {name}.", "parameter.undeclared")
            raise Failed(
                evidence, f"Your node refused {shown({name: value})}, which is valid.", "validation.overzealous"
            )
    require_values(remote, values, shown(values), "Your node accepted the value, but afterwards it has another one.")


def values_in(remote: Remote, expected: Any) -> dict[str, Any]:
    """The values in force of those parameters of which what is expected depends."""
    names = parameters_in(expected)
    return {name: one.value for name, one in remote.values(names).items()} if names else {}


def require_values(
    remote: Remote, values: Mapping[str, Any], sent: str, message: str, diagnosis: str | None = None
) -> None:
    """These values are in force.

    Args:
        remote: whose.
        values: by the parameters' names.
        sent: what was done, in words.
        message: what to say when they are not.
        diagnosis: the code of that.

    Raises:
        Failed: they are not.
    """
    read = {name: one.value for name, one in remote.values(list(values)).items()}
    if read != dict(values):
        raise Failed(Evidence(sent, f"afterwards get_parameters says {shown(values)}", shown(read)), message, diagnosis)

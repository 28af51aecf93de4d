"""Ready-made checks of parameters: functions that return a check."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.answers import are_same, describe_value, only_field
from course_kit.grading.checks.evidence import Evidence, Failed
from course_kit.grading.checks.ready_made import make_check
from course_kit.grading.checks.steps import draw_values

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from typing_extensions import Unpack

    from course_kit.grading.checks.check import Check
    from course_kit.grading.checks.graded_node import GradedNode
    from course_kit.grading.checks.ready_made import CheckFields

_EFFECT_S = 0.2  # rclpy may tell the callbacks of a change after it has answered


def parameter_declared(defaults: dict[str, Any], *, node: str, **declared: Unpack[CheckFields]) -> Check:
    """A check that a node has parameters, with these values at the start, and so with their types.

    Args:
        defaults: by the parameters' names.
        node: its full name.
        declared: see `CheckFields`.

    Example:
        >>> parameter_declared({"max_speed": 1.0}, node="/speed_limiter", check_id="declared",
        ...                    title="max_speed is 1.0 at the start", points=1.0, proves=["parameter"])
    """

    def talk(graded: GradedNode) -> Evidence:
        graded.ensure_running()
        return graded.parameters(node).expect_declared(defaults)

    return make_check(talk, **declared)


def parameter_acts(
    settings: Sequence[dict[str, Any]],
    subscription: str,
    publisher: str,
    messages: Sequence[Any],
    expect: Callable[[Any, dict[str, Any]], Any],
    **declared: Unpack[CheckFields],
) -> Check:
    """A check that parameters which are set change what a node answers. Afterwards they are what they were.

    Args:
        settings: values by the parameters' names, tried one after the other; a value may be a drawing.
        subscription: the topic of the messages that are sent.
        publisher: the topic of the answers.
        messages: what is sent, before and after each change.
        expect: gives what a right answer is for a message and a setting.
        declared: see `CheckFields`.

    Example:
        >>> parameter_acts([{"max_speed": 0.5}, {"max_speed": 2.0}], "/speed_in", "/speed", [3.0, 0.25],
        ...                lambda message, setting: min(message.data, setting["max_speed"]),
        ...                check_id="change", title="A change acts", points=1.0, proves=["change"])
    """

    def answers(node: GradedNode, sent: Sequence[Any]) -> list[Any]:
        return [node.send(subscription, message).expect(publisher) for message in sent]

    def talk(node: GradedNode) -> None:
        sent = [node.message_for(subscription, given) for given in draw_values(messages, node.context.random)]
        for setting in draw_values(settings, node.context.random):
            before, old = node.get(*setting), answers(node, sent)
            node.set(setting).accepted()
            node.wait(_EFFECT_S)
            new = answers(node, sent)
            for message, got in zip(sent, new, strict=True):
                wanted = only_field(got, expect(message, setting))
                if are_same(wanted, got):
                    continue
                why, code = f"Expected {describe_value(wanted)} with the new setting.", "math.formula"
                if new == old:
                    why = "Your node accepted the change, but the output is the same as before."
                    code = "parameter.read_once"
                text = f"set {describe_value(setting)}; {subscription}: {message}"
                raise Failed(Evidence(text, describe_value(wanted), str(got)), why, code)
            node.set(before).accepted()

    return make_check(talk, **declared)


def parameter_refuses(
    settings: Sequence[dict[str, Any]], *, reason: Sequence[str] = (), **declared: Unpack[CheckFields]
) -> Check:
    """A check that a node refuses changes of parameters with a reason, and that their values stay.

    A value of another type, and a parameter that is not declared, need no reason: rclpy gives its own.

    Args:
        settings: values by the parameters' names; several in one are set at once, all or none.
        reason: words that the reason has to contain; any reason will do when there are none.
        declared: see `CheckFields`.

    Example:
        >>> parameter_refuses([{"max_speed": -1.0}, {"max_speed": 0.5, "name": ""}], reason=["max_speed"],
        ...                   check_id="range", title="A negative max_speed is refused", points=1.0, proves=["range"])
    """

    def talk(node: GradedNode) -> None:
        for setting in draw_values(settings, node.context.random):
            before = node.get(*setting)
            alike = all(type(value) is type(before[name]) for name, value in setting.items())
            code = "parameter.undeclared" if None in before.values() else "parameter.type"
            change = node.set(setting)
            change.refused(diagnosis="validation.missing" if alike else code)
            reason_given = change.result.reason
            if alike and (not reason_given.strip() or any(word not in reason_given for word in reason)):
                expected = f"refused, with a reason{' that names ' + ' and '.join(reason) if reason else ''}"
                why = "Your node was right to refuse, but the reason has to say why."
                change.fail(why, expected=expected, diagnosis="validation.no_reason")
            if node.get(*setting) != before:
                why = "The parameter has changed although the change was refused."
                change.fail(why, expected="refused, and nothing changes", diagnosis="parameter.not_atomic")

    return make_check(talk, **declared)

"""Ready-made checks of parameters: functions that return a check."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.answers import are_same, describe_value, only_field
from course_kit.grading.checks.evidence import Evidence, Failed
from course_kit.grading.checks.ready_made import make_check
from course_kit.grading.checks.steps import draw_values
from course_kit.ros.parameters import NOT_SET, to_message, type_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from typing_extensions import Unpack

    from course_kit.grading.checks.check import Check
    from course_kit.grading.checks.graded_node import GradedNode
    from course_kit.grading.checks.parameters import RemoteParameters
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
    return make_check(lambda graded: require_declared(graded, defaults, node), **declared)


def require_declared(graded: GradedNode, values: dict[str, Any], node: str) -> Evidence:
    """See that a node, after its start, has parameters with these values and so with their types."""
    graded.ensure_running()
    remote = graded.parameters(node)
    expect_declared(remote, values)
    expect_types(remote, values)
    return expect_defaults(remote, values)


def expect_declared(remote: RemoteParameters, defaults: Mapping[str, Any]) -> Evidence:
    """A node has parameters with these names."""
    names = remote.names()
    evidence = Evidence(f"list_parameters of {remote.node}", ", ".join(defaults), ", ".join(names) or "no parameters")
    if missing := [name for name in defaults if name not in names]:
        raise Failed(evidence, f"{remote.node} has not declared {', '.join(missing)}.", "parameter.undeclared")
    return evidence


def expect_types(remote: RemoteParameters, defaults: Mapping[str, Any]) -> Evidence:
    """A node's parameters have the types of these values."""
    found = remote.types(defaults)
    wanted = {name: type_of(to_message(name, value).value) for name, value in defaults.items()}
    told, expected = (", ".join(f"{name}: {kind}" for name, kind in kinds.items()) for kinds in (found, wanted))
    evidence = Evidence(f"get_parameters of {remote.node}", expected, told)
    if empty := [name for name, kind in found.items() if kind == NOT_SET]:
        why = f"{' and '.join(empty)} is declared without a value, so there is nothing to read."
        raise Failed(evidence, why, "parameter.default")
    if wrong := [name for name, kind in found.items() if kind != wanted[name]]:
        why = " and ".join(f"{name} is {found[name]}, expected {wanted[name]}" for name in wrong)
        point = any((found[name], wanted[name]) == ("integer", "double") for name in wrong)
        raise Failed(evidence, f"{why}.{' A double needs a decimal point.' if point else ''}", "parameter.type")
    return evidence


def expect_defaults(remote: RemoteParameters, defaults: Mapping[str, Any]) -> Evidence:
    """A node that was just started has these values."""
    found = remote.values(defaults)
    evidence = Evidence(f"get_parameters of {remote.node}", describe_value(defaults), describe_value(found))
    if others := {name: value for name, value in found.items() if value != defaults[name]}:
        wanted = describe_value({name: defaults[name] for name in others})
        why = f"After its start, {remote.node} has {describe_value(others)}, expected {wanted}."
        raise Failed(evidence, why, "parameter.default")
    return evidence


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

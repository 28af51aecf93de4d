"""Ready-made checks of parameters: functions that return a check."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.answers import describe_wanted, differences, only_field
from course_kit.grading.checks.check import Check, Evidence, Failed
from course_kit.grading.checks.parameters import describe_values
from course_kit.grading.checks.ready_made import make_check
from course_kit.grading.checks.steps import draw_values
from course_kit.ros.parameters import NOT_SET

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from typing_extensions import Unpack

    from course_kit.grading.checks.graded_node import GradedNode
    from course_kit.grading.checks.ready_made import CheckFields

_EFFECT_S = 0.2  # rclpy may tell the callbacks of a change after it has answered


def parameter_declared(
    defaults: dict[str, Any],
    *,
    node: str,
    **declared: Unpack[CheckFields],
) -> Check:
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
        graded.meet()
        remote = graded.parameters(node)
        names, found = remote.names(), remote.values(list(defaults))
        evidence = Evidence(
            "get_parameters", describe_wanted(defaults), describe_wanted({k: v.value for k, v in found.items()})
        )
        if missing := [name for name in defaults if name not in names]:
            raise Failed(evidence, f"Your node has not declared {', '.join(missing)}.", "parameter.undeclared")
        if wrong := [name for name, value in defaults.items() if type(found[name].value) is not type(value)]:
            point = " A double needs a decimal point." if any(found[name].type == "integer" for name in wrong) else ""
            told = " and ".join(f"{name} is {found[name].type}" for name in wrong)
            raise Failed(evidence, f"{told}.{point}", "parameter.type")
        if others := {name: found[name].value for name, value in defaults.items() if found[name].value != value}:
            raise Failed(
                evidence, f"Started without settings, your node has {describe_wanted(others)}.", "parameter.default"
            )
        return evidence

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

    def answers(node: GradedNode) -> list[Any]:
        return [node.send(subscription, one).expect(publisher) for one in sent]

    def acts(node: GradedNode, setting: dict[str, Any]) -> None:
        old = answers(node)
        node.set(setting).accepted()
        node.context.wait_until(lambda: False, _EFFECT_S)
        new = answers(node)
        for one, before, got in zip(sent, old, new, strict=True):
            wanted = only_field(got, expect(node.message_for(subscription, one), setting))
            for path, value, found in differences(wanted, got):
                same = all(was == now for was, now in zip(old, new, strict=True))
                why = f"{path} has to be {describe_wanted(value)} now, and is {found!r}."
                if same and before == got:
                    why = "Your node accepted the change, but what comes out is the same as before."
                evidence = Evidence(
                    f"set {describe_values(setting)}; {subscription}: {one}", describe_wanted(wanted), str(found)
                )
                raise Failed(evidence, why, "parameter.read_once" if same else "math.formula")

    sent: list[Any] = []

    def talk(node: GradedNode) -> None:
        sent[:] = [node.message_for(subscription, one) for one in draw_values(messages, node.context.random)]
        for setting in draw_values(settings, node.context.random):
            before = node.get(*setting)
            acts(node, setting)
            node.set(before).accepted()

    return make_check(talk, **declared)


def parameter_refuses(
    settings: Sequence[dict[str, Any]],
    *,
    reason: Sequence[str] = (),
    **declared: Unpack[CheckFields],
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
            node.meet()
            remote = node.parameters()
            before = remote.values(list(setting))
            code = _code_of(setting, before)
            change = node.set(setting)
            change.refused(diagnosis=code)
            told = change.result.reason
            lacks = [word for word in reason if word not in told]
            if code == "validation.missing" and (lacks or not told.strip()):
                why = f"It does not name {' and '.join(lacks)}." if told.strip() else "It is empty."
                change.fail(
                    f"Your node was right to refuse, but the reason has to say why. {why}",
                    expected=f"refused, with a reason{' that names ' + ' and '.join(reason) if reason else ''}",
                    diagnosis="validation.no_reason",
                )
            if remote.values(list(setting)) != before:
                change.fail(
                    "The parameter has changed although the change was refused.",
                    expected="refused, and nothing changes",
                    diagnosis="parameter.not_atomic",
                )

    return make_check(talk, **declared)


def _code_of(setting: dict[str, Any], before: dict[str, Any]) -> str:
    """What it means when a setting is accepted: of values of the right types, that nobody looked at them."""
    if any(one.type == NOT_SET for one in before.values()):
        return "parameter.undeclared"
    same = all(type(value) is type(before[name].value) for name, value in setting.items())
    return "validation.missing" if same else "parameter.type"

"""Exercise 3, the checks of values that are set while the node runs."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from course_kit.graders._limiter import (
    BEYOND,
    BOUNDS,
    RANGES,
    TYPES,
    LimiterSettings,
    Reaction,
    command,
    missing_in_reason,
    same_reaction,
)
from course_kit.graders._limiter import shown as shown_command
from course_kit.graders._limiter_node import (
    BOTH,
    VELOCITY,
    WHEELS,
    Limiter,
    drawn,
    require_refused,
    rest,
)
from course_kit.graders._limiter_status import expect_status
from course_kit.grading.checks.check import Evidence, Failed, check
from course_kit.grading.checks.parameters import require_proper_answer, shown

_REFUSALS = "refusals"  # remembered of a running submission: how it has refused each invalid value
_DIGITS = 9  # decimal places, so that a line with a rounded number shows it
# A valid value, and after it one that no range refuses, but a callback.
_BY_A_CALLBACK = ({"wheel_diameter": 0.5, "max_velocity": 0.0}, {"max_velocity": 1.5, "robot_name": ""})
_BEYOND_AN_EDGE = 1e-4  # nearer ones are left to rclpy, whose ranges have a relative tolerance of 1e-6

if TYPE_CHECKING:
    from collections.abc import Mapping

    from geometry_msgs.msg import Twist

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.parameters import Remote


@check(points=1.0, depends_on=["limits"], proves=["next_message", "ends_valid"])
def change_velocity(context: CheckContext) -> Evidence:
    """A change of max_velocity affects the next command."""
    with Limiter(context) as limiter:
        limiter.driving()
        evidence = Evidence()
        twists = [command(-BEYOND), command(BEYOND)]
        for value in (drawn(context, 2.1, 4.9), drawn(context, 0.2, 0.9), BOUNDS["max_velocity"][1]):
            before = [_seen(limiter, twist) for twist in twists]
            after = limiter.set(max_velocity=value)
            for twist, was in zip(twists, before, strict=True):
                sent = shown({"max_velocity": value})
                evidence = limiter.expect(after, twist, VELOCITY, was=was, sent=sent)
            twists.reverse()  # each direction is once the first after a change
        return evidence


@check(points=1.0, depends_on=["wheel_speed"], proves=["next_message", "ends_valid"])
def change_diameter(context: CheckContext) -> Evidence:
    """A change of wheel_diameter affects the next command."""
    with Limiter(context) as limiter:
        twist = command(limiter.driving().max_velocity)
        evidence = Evidence()
        for value in (drawn(context, 0.2, 0.9), *BOUNDS["wheel_diameter"]):
            was = _seen(limiter, twist)
            after = limiter.set(wheel_diameter=value)
            evidence = limiter.expect(after, twist, WHEELS, was=was, sent=shown({"wheel_diameter": value}))
        return evidence


@check(points=1.0, depends_on=["reacts"], proves=["next_message", "disabled", "one_each_disabled"])
def change_enabled(context: CheckContext) -> Evidence:
    """With enabled=False the robot stands still, with enabled=True it drives again.

    Raises:
        Failed: it does not.
    """
    with Limiter(context) as limiter:
        twist = command(limiter.driving().max_velocity * 0.6, **rest(context))
        drove = _seen(limiter, twist)
        evidence = limiter.expect(limiter.set(enabled=False), twist, BOTH, was=drove, sent="enabled=False")
        _require_one_each(limiter, twist)
        limiter.set(enabled=True)
        again = Evidence(f"enabled=False, then enabled=True; {shown_command(twist)}", drove.shown())
        got = limiter.react(twist, again)
        if not same_reaction(drove, got):
            message = "After enabled=True the node does not do what it did before."
            raise Failed(replace(again, got=got.shown()), message, None if any(got.fields) else "parameter.read_once")
        return evidence


@check(points=0.5, depends_on=["status"], proves=["next_message", "unrounded", "status_line"])
def change_status(context: CheckContext) -> Evidence:
    """A change of robot_name and max_velocity shows in the next /status."""
    with Limiter(context) as limiter:
        was = str(limiter.status.messages[-1].data) if limiter.status.count else None
        values = {
            "robot_name": f"rover_{context.random.randrange(100, 1000)}",
            "max_velocity": round(context.random.uniform(1.1, 1.9), _DIGITS),
        }
        return expect_status(context, limiter.status, limiter.set(**values), was=was, sent=shown(values))


@check(points=2.5, depends_on=["reacts"], deadline_s=12.0, proves=["refused", "ends_refused"])
def refuses(context: CheckContext) -> Evidence:
    """An invalid value is refused, and the old one stays.

    Raises:
        Failed: it is accepted, or kept.
    """
    with Limiter(context) as limiter:
        before = limiter.driving()
        was = _seen(limiter, command(BEYOND))
        values = _invalid(context)
        context.memory[_REFUSALS] = refusals = [_refusal(limiter.remote, *one) for one in values]
        evidence = refusals[-1].evidence
        try:
            _require_unchanged(limiter, before, was, evidence)
        except Failed:
            with suppress(Failed):
                limiter.set_together(**before.to_mapping())
            for one in values:  # which of them was it?
                _require_unchanged(limiter, before, was, _refusal(limiter.remote, *one).evidence)
            raise
        return evidence


@check(points=1.5, depends_on=["refuses"], deadline_s=12.0, proves=["reason"])
def reason(context: CheckContext) -> Evidence:
    """A refusal names the parameter and its range.

    Raises:
        Failed: it does not.
    """
    evidence = Evidence()
    remote = Limiter(context).remote
    refusals = context.memory.get(_REFUSALS)  # of the program that runs; one that was started again is asked again
    for one in refusals or [_refusal(remote, *pair) for pair in _invalid(context)]:
        expected = f"refused, with a reason that names the parameter and its range ({RANGES[one.name]})"
        evidence = replace(one.evidence, expected=expected)
        if lacks := missing_in_reason(one.name, one.reason):
            message = f"Your node was right to refuse, but the reason has to say why. {lacks}"
            raise Failed(evidence, message, "validation.no_reason")
    return evidence


@check(points=0.5, depends_on=["types"], proves=["other_type"])
def wrong_type(context: CheckContext) -> Evidence:
    """A value of another type is refused."""
    with Limiter(context) as limiter:
        evidence = Evidence()
        for name, value in (("max_velocity", "fast"), ("max_velocity", 2), ("enabled", 1), ("robot_name", 7)):
            expected = f"refused: {name} is a {TYPES[name]}"
            evidence = require_refused(limiter.remote.set(name, value), {name: value}, expected, "parameter.type")
        return evidence


@check(points=1.5, depends_on=["reacts"], proves=["atomic"])
def atomic(context: CheckContext) -> Evidence:
    """A valid and an invalid value set atomically change nothing."""
    evidence = Evidence()
    for valid, invalid in (("max_velocity", "wheel_diameter"), ("wheel_diameter", "max_velocity")):
        with Limiter(context) as limiter:
            before = limiter.driving()
            twist = command(BEYOND)
            was = _seen(limiter, twist)
            values = {valid: getattr(before, valid) / 2.0 + BOUNDS[valid][1] / 4.0, invalid: 2.0 * BOUNDS[invalid][1]}
            expected = f"refused, and nothing changed: {invalid} is out of its range"
            outcome = limiter.remote.set_together(values)
            evidence = require_refused(outcome, values, expected, "validation.missing")
            _require_unchanged(limiter, before, was, evidence)
    for values in _BY_A_CALLBACK:
        _require_each_judged(context, values)
    with Limiter(context) as limiter:
        limiter.set_together(max_velocity=drawn(context, 1.1, 2.0), wheel_diameter=drawn(context, 0.2, 0.9))
    return evidence


class _Refusal(NamedTuple):
    """A value of a parameter was refused, for this reason."""

    name: str
    reason: str
    evidence: Evidence


def _refusal(remote: Remote, name: str, value: object) -> _Refusal:
    """Try an invalid value.

    Raises:
        Failed: it was accepted, or refused by rclpy because the callback's answer was none.
    """
    outcome = remote.set(name, value)
    evidence = require_refused(outcome, {name: value}, f"refused: {RANGES[name]}", "validation.missing")
    require_proper_answer(outcome, evidence)
    return _Refusal(name, outcome.reason, evidence)


def _invalid(context: CheckContext) -> list[tuple[str, object]]:
    """Values that are not valid, of each parameter that has a range."""
    (slowest, fastest), (smallest, largest) = BOUNDS["max_velocity"], BOUNDS["wheel_diameter"]
    velocities = (-1.0, slowest, fastest + _BEYOND_AN_EDGE, context.random.uniform(5.1, 20.0), math.inf, math.nan)
    near = (smallest - _BEYOND_AN_EDGE, largest + _BEYOND_AN_EDGE)
    diameters = (0.0, -0.1, *near, context.random.uniform(1.1, 20.0))
    return [
        ("robot_name", ""),
        *(("max_velocity", value) for value in velocities),
        *(("wheel_diameter", value) for value in diameters),
    ]


def _require_each_judged(context: CheckContext, values: Mapping[str, object]) -> None:
    """Of several values the last one is judged as well as the first one."""
    name = list(values)[-1]
    alone = shown({name: values[name]})
    with Limiter(context) as limiter:
        before = limiter.driving()
        if limiter.remote.set(name, values[name]).successful:
            return  # the check `refuses` says so
        was = _seen(limiter, command(BEYOND))
        outcome = limiter.remote.set_together(values)
        evidence = Evidence(shown(values), f"refused, and nothing changed: {alone} is not valid", outcome.shown())
        if outcome.successful:
            message = f"Your node refuses {alone} by itself, and accepts it beside another value: judge each of them."
            raise Failed(evidence, message, "validation.missing")
        _require_unchanged(limiter, before, was, evidence)


def _seen(limiter: Limiter, twist: Twist) -> Reaction:
    """What comes out for a command now, right or not."""
    return limiter.react(twist, Evidence(shown_command(twist), "a message on /cmd_vel and one on /wheel_speed"))


def _require_one_each(limiter: Limiter, twist: Twist) -> None:
    """A command that stops the robot is answered like any other: once on each topic."""
    sent = f"enabled=False; {shown_command(twist)}"
    evidence = Evidence(sent, "one message on /cmd_vel, one on /wheel_speed, and none later")
    counts = limiter.count([twist], evidence)
    if counts != (1, 1):
        evidence = replace(evidence, got=f"{counts[0]} messages on /cmd_vel and {counts[1]} on /wheel_speed")
        raise Failed(evidence, "Publish once for each command, with enabled=False, too.")


def _require_unchanged(limiter: Limiter, before: LimiterSettings, was: Reaction, evidence: Evidence) -> None:
    """After a refusal nothing has changed: neither what the node reports, nor what it does."""
    if (now := limiter.settings()) != before:
        changed = {name: value for name, value in now.to_mapping().items() if value != before.to_mapping()[name]}
        evidence = Evidence(evidence.sent, evidence.expected, f"refused, but now {shown(changed)}")
        raise Failed(evidence, "The parameter has changed although the change was refused.", "parameter.not_atomic")
    twist = command(BEYOND)
    got = limiter.react(twist, Evidence(f"{evidence.sent}; {shown_command(twist)}", evidence.expected))
    if not same_reaction(was, got):
        sent = f"{evidence.sent}; {shown_command(twist)}"
        message = "Your node refused the change, yet it acts on it: it kept a value before it had checked all of them."
        raise Failed(Evidence(sent, was.shown(), got.shown()), message, "parameter.not_atomic")

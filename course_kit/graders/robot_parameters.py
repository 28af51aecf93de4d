"""Exercise 3: the node /velocity_limiter, its parameters set and its topics watched from outside.

What a parameter does is judged by what comes out on the topics. The values that count are those in force, as the
node's own services report them, so that a wrong default costs the points for defaults and no others.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import Twist
from std_msgs.msg import Float64, String

from course_kit.graders import _limiter_starts as starts
from course_kit.graders._limiter import (
    BOUNDS,
    RANGES,
    TYPES,
    Settings,
    command,
    missing_in_reason,
    same_reaction,
    shown,
)
from course_kit.graders._limiter_node import (
    BOTH,
    COMMAND,
    LIMITED,
    NODE,
    STATUS,
    VELOCITY,
    WHEEL,
    WHEELS,
    Limiter,
    endpoints,
    require_proper_answer,
    require_refused,
)
from course_kit.graders._limiter_status import expect_rate, expect_status
from course_kit.grading.checks import Check, Evidence, Failed, check
from course_kit.grading.parameters import INTERFACES as PARAMETER_SERVICES
from course_kit.grading.parameters import expect_served
from course_kit.grading.parameters import shown as shown_values
from course_kit.grading.topics import expect_endpoints

if TYPE_CHECKING:
    from course_kit.grading.bench import Bench

INTERFACES = (Twist, Float64, String, *PARAMETER_SERVICES)
_BEYOND = 9.0  # m/s, above every valid limit
_BURST = 5  # commands at once; a default queue holds ten


@check(points=1.0, deadline_s=12.0)
def node_up(bench: Bench) -> Evidence:
    """The node velocity_limiter comes up and can be asked."""
    endpoints(bench)
    return expect_served(bench, NODE)


@check(points=1.0, depends_on=["node_up"])
def topics(bench: Bench) -> Evidence:
    """The four topics are there, and a default endpoint connects to each."""
    Limiter(bench)
    return expect_endpoints(bench, published=(LIMITED, WHEEL, STATUS), subscribed=(COMMAND,))


@check(points=1.0, depends_on=["node_up"])
def declared(bench: Bench) -> Evidence:
    """The four parameters are declared."""
    names = Limiter(bench).remote.names()
    missing = [name for name in TYPES if name not in names]
    evidence = Evidence("list_parameters", ", ".join(TYPES), ", ".join(names))
    if missing:
        message = f"Your node has not declared {' and '.join(missing)}."
        raise Failed(evidence, message, "parameter.undeclared")
    return evidence


@check(points=1.0, depends_on=["declared"])
def types(bench: Bench) -> Evidence:
    """Each parameter has its type."""
    found = Limiter(bench).remote.values(list(TYPES))
    wrong = [f"{name} is {value.type}" for name, value in found.items() if value.type != TYPES[name]]
    expected = ", ".join(f"{name}: {kind}" for name, kind in TYPES.items())
    evidence = Evidence(
        "get_parameters", expected, ", ".join(f"{name}: {value.type}" for name, value in found.items())
    )
    if wrong:
        raise Failed(evidence, f"{' and '.join(wrong)}. For a double write a decimal point.", "parameter.type")
    return evidence


@check(points=1.0, depends_on=["types"])
def defaults(bench: Bench) -> Evidence:
    """Each parameter has its default."""
    expected, got = Settings().to_mapping(), Limiter(bench).settings().to_mapping()
    wrong = {name: value for name, value in got.items() if value != expected[name]}
    evidence = Evidence("get_parameters", shown_values(expected), shown_values(got))
    if wrong:
        message = f"Started without any settings, your node has {shown_values(wrong)}."
        raise Failed(evidence, message, "parameter.default")
    return evidence


@check(points=1.0, depends_on=["types", "topics"])
def reacts(bench: Bench) -> Evidence:
    """A command on /cmd_vel_in brings a message on /cmd_vel and on /wheel_speed."""
    limiter = Limiter(bench)
    limiter.driving()
    twist = command(0.1)
    expected = "a message on /cmd_vel and one on /wheel_speed"
    limiter.react(twist, Evidence(shown(twist), expected))
    return Evidence(shown(twist), expected, expected)


@check(points=1.5, depends_on=["reacts"])
def limits(bench: Bench) -> Evidence:
    """linear.x is limited in both directions, and nothing else is changed."""
    limiter = Limiter(bench)
    settings = limiter.driving()
    within = settings.max_velocity * bench.random.uniform(0.2, 0.9)
    limiter.expect(settings, command(within, **_rest(bench)), VELOCITY)
    limiter.expect(settings, command(-within, **_rest(bench)), VELOCITY)
    limiter.expect(settings, command(-_BEYOND, **_rest(bench)), VELOCITY)
    return limiter.expect(settings, command(_BEYOND, **_rest(bench)), VELOCITY)


@check(points=1.0, depends_on=["reacts"])
def wheel_speed(bench: Bench) -> Evidence:
    """/wheel_speed is the wheel's speed in rad/s for the published velocity."""
    limiter = Limiter(bench)
    settings = limiter.driving()
    for speed in (0.0, -settings.max_velocity * 0.37, _BEYOND):
        limiter.expect(settings, command(speed), WHEELS)
    return limiter.expect(settings, command(settings.max_velocity * bench.random.uniform(0.2, 0.9)), WHEELS)


@check(points=0.5, depends_on=["reacts"])
def one_each(bench: Bench) -> Evidence:
    """Each command brings exactly one message on each topic."""
    limiter = Limiter(bench)
    limiter.driving()
    burst = [command(0.01 * number) for number in range(1, _BURST + 1)]
    expected = f"{_BURST} messages on /cmd_vel and {_BURST} on /wheel_speed"
    evidence = Evidence(f"{_BURST} commands on /cmd_vel_in", expected)
    before = [len(heard) for heard in limiter.heard()]
    limiter.react_to_all(burst, evidence)
    limiter.react(command(0.0), evidence)  # on each topic the messages come in order: what came before this is all
    counts = [len(heard) - had - 1 for heard, had in zip(limiter.heard(), before, strict=True)]
    got = f"{counts[0]} messages on /cmd_vel and {counts[1]} on /wheel_speed"
    evidence = Evidence(evidence.sent, expected, got)
    if counts != [_BURST, _BURST]:
        raise Failed(evidence, "Publish once for each command, in the callback that receives it.")
    return evidence


@check(points=1.0, depends_on=["types", "topics"])
def status(bench: Bench) -> Evidence:
    """/status tells the name and the velocity."""
    limiter = Limiter(bench)
    return expect_status(bench, limiter.status, limiter.settings())


@check(points=1.0, depends_on=["limits"])
def change_velocity(bench: Bench) -> Evidence:
    """A change of max_velocity acts on the next command."""
    limiter = Limiter(bench)
    evidence = Evidence()
    for value in (_drawn(bench, 2.1, 4.9), _drawn(bench, 0.2, 0.9)):
        before = limiter.driving()
        after = limiter.set(max_velocity=value)
        sent = shown_values({"max_velocity": value})
        for speed in (-_BEYOND, _BEYOND):
            evidence = limiter.expect(after, command(speed), VELOCITY, before=before, sent=sent)
    return evidence


@check(points=1.0, depends_on=["wheel_speed"])
def change_diameter(bench: Bench) -> Evidence:
    """A change of wheel_diameter acts on the next command."""
    limiter = Limiter(bench)
    before = limiter.driving()
    evidence = Evidence()
    for value in (_drawn(bench, 0.2, 0.9), 0.02):
        after = limiter.set(wheel_diameter=value)
        sent = shown_values({"wheel_diameter": value})
        evidence = limiter.expect(after, command(before.max_velocity), WHEELS, before=before, sent=sent)
        before = after
    return evidence


@check(points=1.0, depends_on=["reacts"])
def change_enabled(bench: Bench) -> Evidence:
    """With enabled false the robot stands still, with true it drives again."""
    limiter = Limiter(bench)
    before = limiter.driving()
    twist = command(before.max_velocity * 0.6, **_rest(bench))
    stopped = limiter.set(enabled=False)
    evidence = limiter.expect(stopped, twist, BOTH, before=before, sent="enabled=False")
    resumed = limiter.set(enabled=True)
    got = limiter.react(twist, Evidence(f"enabled=True; {shown(twist)}", "the command as before"))
    if got.fields[0] == 0.0:
        limiter.expect(resumed, twist, VELOCITY, before=stopped, sent="enabled=True")
    return evidence


@check(points=0.5, depends_on=["status"])
def change_status(bench: Bench) -> Evidence:
    """A change of robot_name and max_velocity shows in the next /status."""
    limiter = Limiter(bench)
    before = limiter.settings()
    values = {"robot_name": f"rover_{bench.random.randrange(100, 1000)}", "max_velocity": _drawn(bench, 1.1, 2.0)}
    after = limiter.set(**values)
    return expect_status(bench, limiter.status, after, before=before, sent=shown_values(values))


@check(points=2.0, depends_on=["reacts"], deadline_s=12.0)
def refuses(bench: Bench) -> Evidence:
    """An invalid value is refused with a reason, and the old one stays in force."""
    evidence = Evidence()
    velocities = (-1.0, bench.random.uniform(5.1, 20.0), math.inf, math.nan)
    diameters = (0.0, -0.1, bench.random.uniform(1.1, 20.0))
    attempts = [("robot_name", ""), *(("max_velocity", v) for v in velocities)]
    for name, value in [*attempts, *(("wheel_diameter", d) for d in diameters)]:
        limiter = Limiter(bench)
        before = limiter.driving()
        twist = command(_BEYOND)
        was = limiter.react(twist, Evidence(shown(twist), "a message on each topic"))
        expected = f"refused, with a reason that names the parameter and its range ({RANGES[name]})"
        outcome = limiter.remote.set(name, value)
        evidence = require_refused(outcome, {name: value}, expected, "validation.missing")
        require_proper_answer(outcome, evidence)
        if lacks := missing_in_reason(name, outcome.reason):
            message = f"Refusing is right; but whoever has set the value needs to know why. {lacks}"
            raise Failed(evidence, message, "validation.no_reason")
        _require_unchanged(limiter, before, was, evidence)
    return evidence


@check(points=0.5, depends_on=["types"])
def wrong_type(bench: Bench) -> Evidence:
    """A value of another type is refused."""
    limiter = Limiter(bench)
    evidence = Evidence()
    for name, value in (("max_velocity", "fast"), ("max_velocity", 2), ("enabled", 1), ("robot_name", 7)):
        expected = f"refused: {name} is a {TYPES[name]}"
        evidence = require_refused(limiter.remote.set(name, value), {name: value}, expected, "parameter.type")
    return evidence


@check(points=0.5, depends_on=["declared"])
def undeclared(bench: Bench) -> Evidence:
    """A parameter that is not declared is refused."""
    name = f"wheel_count_{bench.random.randrange(100, 1000)}"
    outcome = Limiter(bench).remote.set(name, 4)
    return require_refused(outcome, {name: 4}, "refused: there is no such parameter", "parameter.undeclared")


@check(points=1.0, depends_on=["reacts"])
def atomic(bench: Bench) -> Evidence:
    """Set atomically, a valid and an invalid value change nothing."""
    evidence = Evidence()
    for valid, invalid in (("max_velocity", "wheel_diameter"), ("wheel_diameter", "max_velocity")):
        limiter = Limiter(bench)
        before = limiter.driving()
        twist = command(_BEYOND)
        was = limiter.react(twist, Evidence(shown(twist), "a message on each topic"))
        values = {valid: getattr(before, valid) / 2.0 + BOUNDS[valid][1] / 4.0, invalid: 2.0 * BOUNDS[invalid][1]}
        expected = f"refused, and nothing changed: {invalid} is out of its range"
        outcome = limiter.remote.set_together(values)
        evidence = require_refused(outcome, values, expected, "validation.missing")
        _require_unchanged(limiter, before, was, evidence)
    limiter.set_together(max_velocity=_drawn(bench, 1.1, 2.0), wheel_diameter=_drawn(bench, 0.2, 0.9))
    return evidence


@check(points=0.5, depends_on=["status"], deadline_s=12.0)
def status_rate(bench: Bench) -> Evidence:
    """/status comes twice a second."""
    return expect_rate(bench, Limiter(bench).status)


@check(points=1.0, depends_on=["limits", "wheel_speed"], deadline_s=15.0)
def start_arguments(bench: Bench) -> Evidence:
    """Values given at the start by -p are in force."""
    values = {"max_velocity": _drawn(bench, 2.1, 4.9), "wheel_diameter": _drawn(bench, 0.2, 0.9)}
    return starts.expect_arguments(bench, values)


@check(points=0.5, depends_on=["limits"], deadline_s=15.0)
def start_file(bench: Bench) -> Evidence:
    """Values given at the start by a parameter file are in force."""
    return starts.expect_file(bench, {"max_velocity": _drawn(bench, 2.1, 4.9), "enabled": False})


@check(points=0.5, depends_on=["start_arguments", "defaults"], deadline_s=25.0)
def start_invalid(bench: Bench) -> Evidence:
    """An invalid value given at the start is not taken, and the node says so."""
    values = {"max_velocity": -_drawn(bench, 0.5, 3.0), "wheel_diameter": _drawn(bench, 2.0, 9.0)}
    return starts.expect_invalid(bench, values)


CHECKS: tuple[Check, ...] = (
    node_up,
    topics,
    declared,
    types,
    defaults,
    reacts,
    limits,
    wheel_speed,
    one_each,
    status,
    change_velocity,
    change_diameter,
    change_enabled,
    change_status,
    refuses,
    wrong_type,
    undeclared,
    atomic,
    status_rate,
    start_arguments,
    start_file,
    start_invalid,
)


def _drawn(bench: Bench, low: float, high: float) -> float:
    """A value with one decimal place, which survives whatever format a status line is written in."""
    return round(bench.random.uniform(low, high), 1)


def _rest(bench: Bench) -> dict[str, float]:
    """Values for the fields of a command that pass unchanged."""
    return {name: bench.random.uniform(-1.0, 1.0) for name in ("linear_y", "linear_z", "angular_x", "angular_z")}


def _require_unchanged(limiter: Limiter, before: Settings, was: Any, evidence: Evidence) -> None:
    """After a refusal nothing has changed: neither what the node reports, nor what it does."""
    if (now := limiter.settings()) != before:
        changed = {name: value for name, value in now.to_mapping().items() if value != before.to_mapping()[name]}
        evidence = Evidence(evidence.sent, evidence.expected, f"refused, and yet now {shown_values(changed)}")
        raise Failed(evidence, "The parameter has changed although the change was refused.", "parameter.not_atomic")
    twist = command(_BEYOND)
    got = limiter.react(twist, Evidence(f"{evidence.sent}; {shown(twist)}", evidence.expected))
    if not same_reaction(was, got):
        sent = f"{evidence.sent}; {shown(twist)}"
        message = "The change was refused, and yet your node acts on it: it had kept a value before it knew the answer."
        raise Failed(Evidence(sent, was.shown(), got.shown()), message, "parameter.not_atomic")

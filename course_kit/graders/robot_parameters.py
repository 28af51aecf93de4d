"""Exercise 3: the node /velocity_limiter, its parameters set and its topics watched from outside.

What a parameter does is judged by what comes out on the topics. The values that count are those in force, as the
node's own services report them, so that a wrong default costs the points for defaults and no others.
"""

from __future__ import annotations

import random
from dataclasses import replace
from typing import TYPE_CHECKING

from geometry_msgs.msg import Twist
from std_msgs.msg import Float64, String

from course_kit.graders import _limiter_changes as changes
from course_kit.graders import _limiter_starts as starts
from course_kit.graders._limiter import BEYOND, command, shown
from course_kit.graders._limiter_node import (
    NODE,
    VELOCITY,
    WHEELS,
    Limiter,
    drawn,
    endpoints,
    rest,
)
from course_kit.graders._limiter_status import expect_status
from course_kit.grading.checks.check import Check, Evidence, Failed, check
from course_kit.grading.checks.parameters import INTERFACES as PARAMETER_SERVICES
from course_kit.grading.checks.parameters import expect_served

if TYPE_CHECKING:
    from course_kit.grading.checks.context import CheckContext

INTERFACES = (Twist, Float64, String, *PARAMETER_SERVICES)
_AT_START = {"max_velocity": (2.1, 4.9), "wheel_diameter": (0.2, 0.9)}  # m/s, m: unlike the defaults
_COMMANDS = 5  # one after the other: a queue may have any depth, 1 included


@check(points=0.5, deadline_s=12.0, proves=["node", "only_a_class", "a_program", "start"])
def node_up(context: CheckContext) -> Evidence:
    """The node velocity_limiter comes up and can be asked."""
    endpoints(context)
    return expect_served(context, NODE)


@check(
    points=0.5, depends_on=["types", "topics"], proves=["within_3_s", "topic_command", "topic_velocity", "topic_wheel"]
)
def reacts(context: CheckContext) -> Evidence:
    """A command on /cmd_vel_in brings a message on /cmd_vel and on /wheel_speed."""
    with Limiter(context) as limiter:
        limiter.driving()
        twist = command(0.1)
        expected = "a message on /cmd_vel and one on /wheel_speed"
        limiter.react(twist, Evidence(shown(twist), expected))
        return Evidence(shown(twist), expected, expected)


@check(points=1.5, depends_on=["reacts"], proves=["limited", "sign_and_rest"])
def limits(context: CheckContext) -> Evidence:
    """linear.x is limited in both directions, and nothing else is changed."""
    with Limiter(context) as limiter:
        settings = limiter.driving()
        within = settings.max_velocity * context.random.uniform(0.2, 0.9)
        limiter.expect(settings, command(within, **rest(context)), VELOCITY)
        limiter.expect(settings, command(-within, **rest(context)), VELOCITY)
        limiter.expect(settings, command(-BEYOND, **rest(context)), VELOCITY)
        return limiter.expect(settings, command(BEYOND, **rest(context)), VELOCITY)


@check(points=1.0, depends_on=["reacts"], proves=["wheels"])
def wheel_speed(context: CheckContext) -> Evidence:
    """/wheel_speed is the wheel's speed in rad/s for the published velocity."""
    with Limiter(context) as limiter:
        settings = limiter.driving()
        for speed in (0.0, -settings.max_velocity * 0.37, BEYOND):
            limiter.expect(settings, command(speed), WHEELS)
        return limiter.expect(settings, command(settings.max_velocity * context.random.uniform(0.2, 0.9)), WHEELS)


@check(points=0.5, depends_on=["reacts"], proves=["one_each"])
def one_each(context: CheckContext) -> Evidence:
    """Each command brings exactly one message on each topic.

    Raises:
        Failed: it brings none, or more.
    """
    with Limiter(context) as limiter:
        limiter.driving()
        commands = [command(0.01 * number) for number in range(1, _COMMANDS + 1)]
        expected = f"{_COMMANDS} messages on /cmd_vel and {_COMMANDS} on /wheel_speed, and none later"
        evidence = Evidence(f"{_COMMANDS} commands on /cmd_vel_in, one after the other", expected)
        counts = limiter.count(commands, evidence)
        evidence = replace(evidence, got=f"{counts[0]} messages on /cmd_vel and {counts[1]} on /wheel_speed")
        if counts != (_COMMANDS, _COMMANDS):
            raise Failed(evidence, "Publish once for each command, in the callback that receives it.")
        return evidence


@check(points=1.0, depends_on=["types", "topics"], proves=["status_line", "topic_status"])
def status(context: CheckContext) -> Evidence:
    """/status shows the name and the velocity."""
    with Limiter(context) as limiter:
        return expect_status(context, limiter.status, limiter.settings())


@check(
    points=1.0, depends_on=["limits", "wheel_speed"], deadline_s=25.0, proves=["start_arguments", "init_sees_arguments"]
)
def start_arguments(context: CheckContext) -> Evidence:
    """Values given at the start with -p take effect."""
    return starts.expect_arguments(context, _given(context))


@check(points=0.5, depends_on=["limits", "status"], deadline_s=25.0, proves=["start_file"])
def start_file(context: CheckContext) -> Evidence:
    """Values given at the start in a parameter file take effect."""
    return starts.expect_file(context, _given(context))


@check(points=1.0, depends_on=["start_arguments", "defaults"], deadline_s=25.0, proves=["start_invalid"])
def start_invalid(context: CheckContext) -> Evidence:
    """An invalid value given at the start is not used, and the node says so."""
    values = {"max_velocity": -drawn(context, 1.5, 3.0), "wheel_diameter": drawn(context, 2.0, 9.0)}
    return starts.expect_invalid(context, values)


CHECKS: tuple[Check, ...] = (
    node_up,
    reacts,
    limits,
    wheel_speed,
    one_each,
    status,
    changes.change_velocity,
    changes.change_diameter,
    changes.change_enabled,
    changes.change_status,
    changes.refuses,
    changes.reason,
    changes.wrong_type,
    changes.atomic,
    start_arguments,
    start_file,
    start_invalid,
)


def _given(context: CheckContext) -> starts.Given:
    """Values for all parameters, the same each time it is called in a grading."""
    draw = random.Random(context.job.seed)  # noqa: S311 - test values, not secrets
    arguments = {name: round(draw.uniform(*ends), 1) for name, ends in _AT_START.items()}
    return starts.Given(arguments, {"robot_name": f"rover_{draw.randrange(100, 1000)}", "enabled": False})

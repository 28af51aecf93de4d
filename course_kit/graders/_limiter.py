"""What a velocity limiter has to do with a command, given its parameters; and what a wrong one did instead."""

from __future__ import annotations

import math
import re
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from geometry_msgs.msg import Twist

from course_kit.grading.checks.parameters import yaml

if TYPE_CHECKING:
    from collections.abc import Mapping

    from std_msgs.msg import Float64

_RELATIVE, _ABSOLUTE = 1e-6, 1e-9
_UNIT = "m/s"
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_FIELDS = [f"{part}.{axis}" for part in ("linear", "angular") for axis in "xyz"]
_OTHERS = _FIELDS[1:]


@dataclass(frozen=True)
class LimiterSettings:
    """The values of the four parameters; the defaults are those of the exercise."""

    robot_name: str = "default_robot"
    max_velocity: float = 1.0  # m/s
    wheel_diameter: float = 0.1  # m
    enabled: bool = True

    def to_mapping(self) -> dict[str, object]:
        """The values by name."""
        return asdict(self)


TYPES = {"robot_name": "string", "max_velocity": "double", "wheel_diameter": "double", "enabled": "bool"}
BOUNDS = {"max_velocity": (0.0, 5.0), "wheel_diameter": (0.01, 1.0)}
BEYOND = 9.0  # m/s, above every valid limit
RANGES = {
    "robot_name": "not empty",
    "max_velocity": "0.0 < max_velocity <= 5.0",
    "wheel_diameter": "0.01 <= wheel_diameter <= 1.0",
}


@dataclass(frozen=True)
class Reaction:
    """What comes out for one command: the fields of /cmd_vel in the order of geometry_msgs/Twist, and /wheel_speed."""

    fields: tuple[float, ...]
    wheel: float

    @classmethod
    def of(cls, twist: Twist, wheel: Float64) -> Reaction:
        """From the messages."""
        return cls(fields_of(twist), float(wheel.data))

    def shown(self) -> str:
        """As the learner is shown it."""
        return f"/cmd_vel {_shown(self.fields)}; /wheel_speed {self.wheel:.6g}"


def command(linear_x: float, **others: float) -> Twist:
    """A command; `others` by name with an underscore, `angular_z=0.3`, in m/s and rad/s."""
    twist = Twist()
    twist.linear.x = linear_x
    for name, value in others.items():
        part, _, axis = name.partition("_")
        setattr(getattr(twist, part), axis, value)
    return twist


def shown(twist: Twist) -> str:
    """A command as the learner is shown it."""
    return f"/cmd_vel_in {_shown(fields_of(twist))}"


def fields_of(twist: Twist) -> tuple[float, ...]:
    """The six numbers of a Twist."""
    return tuple(float(getattr(part, axis)) for part in (twist.linear, twist.angular) for axis in "xyz")


def right_fields(settings: LimiterSettings, twist: Twist) -> tuple[float, ...]:
    """What has to come out on /cmd_vel."""
    linear_x, *others = fields_of(twist)
    if not settings.enabled:
        return (0.0,) * len(_FIELDS)
    return (min(max(linear_x, -settings.max_velocity), settings.max_velocity), *others)


def right_wheel(settings: LimiterSettings, published: float) -> float:
    """What has to come out on /wheel_speed, in rad/s, for the linear.x that was published, in m/s."""
    return _over(published, settings.wheel_diameter / 2.0) if settings.enabled else 0.0


def right_reaction(settings: LimiterSettings, twist: Twist) -> Reaction:
    """What has to come out."""
    fields = right_fields(settings, twist)
    return Reaction(fields, right_wheel(settings, fields[0]))


def velocity_fits(settings: LimiterSettings, twist: Twist, got: Reaction) -> bool:
    """Whether /cmd_vel is right.

    Args:
        settings: what the parameters were set to.
        twist: the command.
        got: what came for it.
    """
    return all(_same(one, two) for one, two in zip(right_fields(settings, twist), got.fields, strict=True))


def wheel_fits(settings: LimiterSettings, got: Reaction) -> bool:
    """Whether /wheel_speed is right for the /cmd_vel beside it."""
    return _same(got.wheel, right_wheel(settings, got.fields[0]))


def same_reaction(one: Reaction, two: Reaction) -> bool:
    """Whether two reactions are the same, but for digits that do not count."""
    return all(_same(a, b) for a, b in zip((*one.fields, one.wheel), (*two.fields, two.wheel), strict=True))


def explain_velocity(settings: LimiterSettings, twist: Twist, got: Reaction) -> tuple[str | None, str]:
    """What is wrong with a /cmd_vel: the diagnosis, if there is one, and a sentence.

    Args:
        settings: what the parameters were set to.
        twist: the command.
        got: what came for it.
    """
    asked, right = fields_of(twist)[0], right_fields(settings, twist)
    if not settings.enabled:
        return None, "With enabled=False every field of /cmd_vel has to be 0, so that the robot stands still."
    pairs = zip(_OTHERS, right[1:], got.fields[1:], strict=True)
    if changed := [name for name, one, two in pairs if not _same(one, two)]:
        return (
            None,
            f"Only linear.x has to be limited; the other fields pass unchanged. Look at {' and '.join(changed)}.",
        )
    if _same(got.fields[0], asked):
        return (
            "math.formula",
            f"linear.x passed unchanged, although it is beyond max_velocity={settings.max_velocity:g}.",
        )
    if _same(got.fields[0], -right[0]):
        return "math.formula", "The size is right but the sign is wrong: a command to drive backwards has to stay one."
    return "math.formula", f"linear.x has to be {right[0]:g} here, with max_velocity={settings.max_velocity:g}."


def explain_wheel(settings: LimiterSettings, twist: Twist, got: Reaction, *, floors: bool) -> tuple[str, str]:
    """What is wrong with a /wheel_speed: the diagnosis and a sentence.

    Args:
        settings: the settings in force.
        twist: the command.
        got: what came out for it.
        floors: whether the learner's program uses `//`.
    """
    speed, diameter, asked = got.fields[0], settings.wheel_diameter, fields_of(twist)[0]
    slips = (
        (_over(speed, diameter), "This is the speed divided by the diameter; the radius is half of it."),
        (speed * diameter / 2.0, "This is the speed times the radius; the smaller a wheel, the faster it turns."),
        (_over(speed, math.pi * diameter), "These are turns per second; the topic wants rad/s."),
        (_over(asked, diameter / 2.0), "This belongs to the command that came in, not to the one you have published."),
        (_over(-speed, diameter / 2.0), "The sign is wrong: a wheel that turns backwards has a negative speed."),
        (speed, "This is the speed itself, in m/s; the topic wants rad/s."),
    )
    if not settings.enabled:
        return "math.formula", "With enabled=False the robot stands still, and so do its wheels."
    for value, told in slips:
        if _same(got.wheel, value):
            return "math.formula", told
    off = abs(got.wheel - right_wheel(settings, speed))
    if off <= 1.0 and (got.wheel == round(got.wheel) or floors):
        return "math.integer_division", "Digits were lost in the calculation: look for //, int() and round()."
    return "math.formula", "It matches none of the usual mistakes; work it out by hand: rad/s = (m/s) / radius in m."


def read_status(text: str) -> tuple[str, float] | None:
    """Name and velocity of a status line, or None when it is none."""
    line = text.strip()
    if not line.endswith(_UNIT):
        return None
    body = line.removesuffix(_UNIT).rstrip()
    number = (body.rsplit(None, 1) or [""])[-1]
    name = body.removesuffix(number)
    if name.rstrip().endswith(":"):
        name = name.rstrip()[:-1]
    else:  # no blank after the colon, or no colon
        more, colon, number = number.partition(":")
        if not colon:
            return None
        name += more
    try:
        return name.strip(), float(number)
    except ValueError:
        return None


def status_fits(settings: LimiterSettings, text: str) -> bool:
    """Whether a status line tells the name and the velocity, the latter compared as a number, with all its digits."""
    return read_status(text) == (settings.robot_name, settings.max_velocity)


def status_line(settings: LimiterSettings) -> str:
    """A right status line."""
    return f"{settings.robot_name}: {settings.max_velocity!r} m/s"


def missing_in_reason(name: str, reason: str) -> str:
    """What a reason for refusing a value of the parameter `name` lacks, in words; nothing when it is complete."""
    if not reason.strip():
        return "It is empty."
    if name not in reason:
        return f"It does not name the parameter, {name}."
    numbers = {float(number) for number in _NUMBER.findall(reason)}
    if name in BOUNDS and not numbers & set(BOUNDS[name]):
        return f"It does not give the range: {RANGES[name]}."
    return ""


def parameter_file(node: str, values: Mapping[str, object]) -> str:
    """A YAML file of parameters for a node, as `--params-file` reads it (ROS 2: Node arguments)."""
    lines = [f"    {name}: {yaml(value)}" for name, value in values.items()]
    return "\n".join([f"{node.lstrip('/')}:", "  ros__parameters:", *lines]) + "\n"


def _shown(fields: tuple[float, ...]) -> str:
    told = [f"{name}={value:.6g}" for name, value in zip(_FIELDS, fields, strict=True) if value != 0.0]
    return ", ".join(told) or "all fields 0"


def _over(one: float, other: float) -> float:
    """A quotient; NaN where there is none: the settings are a stranger's."""
    return one / other if other else math.nan


def _same(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=_RELATIVE, abs_tol=_ABSOLUTE)

"""What a velocity limiter has to do with a command, given its parameters; and what a wrong one did instead."""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from geometry_msgs.msg import Twist

if TYPE_CHECKING:
    import random
    from collections.abc import Iterator, Mapping, Sequence

    from std_msgs.msg import Float64

_RELATIVE, _ABSOLUTE = 1e-6, 1e-9
# Of an end, as a share: rclpy's own text has the smallest number above 0 for a range that excludes 0, and who has the
# end itself wrong loses no points here.
_NEAR = 0.15
_UNIT = "m/s"
BEYOND = 9.0  # m/s, above every valid limit
_REMEMBERED = 6  # refused changes, of which a wrong node may have kept some
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
FIELDS = [(part, axis) for part in ("linear", "angular") for axis in "xyz"]
_NAMES = [".".join(field) for field in FIELDS]
TYPES = {"robot_name": "string", "max_velocity": "double", "wheel_diameter": "double", "enabled": "bool"}
_PYTHON = {"string": str, "double": float, "bool": bool}
BOUNDS = {"max_velocity": (0.0, 5.0), "wheel_diameter": (0.01, 1.0)}
RANGES = {
    "robot_name": "not empty",
    "max_velocity": "0.0 < max_velocity <= 5.0",
    "wheel_diameter": "0.01 <= wheel_diameter <= 1.0",
}


@dataclass(frozen=True)
class LimiterSettings:
    """The values of the four parameters; the defaults are those of the exercise."""

    robot_name: str = "default_robot"
    max_velocity: float = 1.0  # m/s
    wheel_diameter: float = 0.1  # m
    enabled: bool = True

    def to_mapping(self) -> dict[str, Any]:
        """The values by name."""
        return asdict(self)

    def of(self, name: str) -> Any:
        """The value of one parameter."""
        return getattr(self, name)

    def with_some(self, refused: Sequence[Mapping[str, Any]]) -> Iterator[tuple[LimiterSettings, Mapping[str, Any]]]:
        """The settings of a node which keeps some of these refused values, each with the last change it has kept."""
        kept: dict[str, list[tuple[Any, int]]] = {name: [(self.of(name), -1)] for name in TYPES}
        recent = refused[-_REMEMBERED:]
        for number, values in enumerate(recent):
            for name, value in values.items():
                if type(value) is _PYTHON[TYPES[name]]:
                    kept[name].append((value, number))
        for some in itertools.product(*kept.values()):
            last = max(number for _, number in some)
            if last >= 0:
                yield LimiterSettings(*(value for value, _ in some)), recent[last]


DEFAULTS = LimiterSettings()


def is_valid(name: str, value: object) -> bool:
    """Whether a parameter may have a value."""
    if type(value) is not _PYTHON[TYPES[name]]:
        return False
    if name == "max_velocity":
        return 0.0 < value <= BOUNDS[name][1]  # type: ignore[operator]
    if name == "wheel_diameter":
        return BOUNDS[name][0] <= value <= BOUNDS[name][1]  # type: ignore[operator]
    return value != ""


@dataclass(frozen=True)
class Reaction:
    """What comes out for one command: the fields of /cmd_vel in the order of geometry_msgs/Twist, and /wheel_speed."""

    fields: tuple[float, ...]
    wheel: float

    @classmethod
    def of(cls, twist: Twist, wheel: Float64) -> Reaction:
        """From the messages."""
        return cls(tuple(float(getattr(getattr(twist, part), axis)) for part, axis in FIELDS), float(wheel.data))

    def shown(self) -> str:
        """As the learner is shown it."""
        return f"/cmd_vel {self.shown_fields()}; /wheel_speed {self.wheel:.6g}"

    def shown_fields(self) -> str:
        """The fields of /cmd_vel that are not 0."""
        told = [f"{name}={value:.6g}" for name, value in zip(_NAMES, self.fields, strict=True) if value != 0.0]
        return ", ".join(told) or "all fields 0"


def right_reaction(settings: LimiterSettings, fields: Sequence[float]) -> Reaction:
    """What has to come out for a command with these fields."""
    if not settings.enabled:
        return Reaction((0.0,) * len(FIELDS), 0.0)
    limited = min(max(fields[0], -settings.max_velocity), settings.max_velocity)
    return Reaction((limited, *fields[1:]), _over(limited, settings.wheel_diameter / 2.0))


def same_reaction(one: Reaction, two: Reaction) -> bool:
    """Whether two reactions are the same, but for digits that do not count."""
    return all(_same(a, b) for a, b in zip((*one.fields, one.wheel), (*two.fields, two.wheel), strict=True))


def same_velocity(one: Reaction, two: Reaction) -> bool:
    """Whether two reactions have the same /cmd_vel."""
    return all(map(_same, one.fields, two.fields))


def cause_of(
    settings: LimiterSettings, fields: Sequence[float], got: Reaction, *, floors: bool
) -> tuple[bool, str | None, str]:
    """What is wrong with a reaction: whether /wheel_speed alone is, the diagnosis, and a sentence.

    Args:
        settings: what the parameters were set to.
        fields: of the command.
        got: what came for it.
        floors: whether the learner's program uses `//`.
    """
    right = right_reaction(settings, fields)
    if all(map(_same, right.fields, got.fields)):
        return (True, *_cause_of_wheel(settings, fields, got, floors=floors))
    if not settings.enabled:
        return False, None, "With enabled=False every field of /cmd_vel has to be 0, so that the robot stands still."
    pairs = zip(_NAMES[1:], right.fields[1:], got.fields[1:], strict=True)
    if changed := [name for name, one, two in pairs if not _same(one, two)]:
        told = f"Only linear.x has to be limited; the other fields pass unchanged. Look at {' and '.join(changed)}."
        return False, None, told
    if _same(got.fields[0], fields[0]):
        told = f"linear.x passed unchanged, although it is beyond max_velocity={settings.max_velocity:g}."
    elif _same(got.fields[0], -right.fields[0]):
        told = "The size is right but the sign is wrong: a command to drive backwards has to stay one."
    else:
        told = f"linear.x has to be {right.fields[0]:g} here, with max_velocity={settings.max_velocity:g}."
    return False, "math.formula", told


def _cause_of_wheel(
    settings: LimiterSettings, fields: Sequence[float], got: Reaction, *, floors: bool
) -> tuple[str, str]:
    speed, diameter, asked = got.fields[0], settings.wheel_diameter, fields[0]
    if not settings.enabled:
        return "math.formula", "With enabled=False the robot stands still, and so do its wheels."
    slips = (
        (_over(speed, diameter), "This is the speed divided by the diameter; the radius is half of it."),
        (speed * diameter / 2.0, "This is the speed times the radius; the smaller a wheel, the faster it turns."),
        (_over(speed, math.pi * diameter), "These are turns per second; the topic wants rad/s."),
        (_over(asked, diameter / 2.0), "This belongs to the command that came in, not to the one you have published."),
        (_over(-speed, diameter / 2.0), "The sign is wrong: a wheel that turns backwards has a negative speed."),
        (speed, "This is the speed itself, in m/s; the topic wants rad/s."),
    )
    for value, told in slips:
        if _same(got.wheel, value):
            return "math.formula", told
    off = abs(got.wheel - _over(speed, diameter / 2.0))
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


def status_line(settings: LimiterSettings) -> str:
    """A right status line."""
    return f"{settings.robot_name}: {settings.max_velocity!r} m/s"


def what_is_wrong_with_status(settings: LimiterSettings, line: str) -> str:
    """What a status line does not tell, for the learner."""
    read = read_status(line)
    if read is None:
        return "The line has to have the form <name>: <max_velocity> m/s, with a number in place of <max_velocity>."
    if read[0] != settings.robot_name.strip():
        return f"The line begins with {read[0]!r}; robot_name is {settings.robot_name!r}."
    return f"The line says {read[1]!r} m/s; max_velocity is {settings.max_velocity!r}, unrounded."


def missing_in_reason(name: str, value: Any, reason: str) -> str:
    """What a reason for refusing a value lacks, in words; nothing when it is complete.

    Args:
        name: the parameter's.
        value: the invalid value.
        reason: what the node says.
    """
    if not reason.strip():
        return "It is empty."
    if name not in reason:
        return f"It does not name the parameter, {name}."
    numbers = {float(number) for number in _NUMBER.findall(reason)}
    if name in BOUNDS:
        low, high = BOUNDS[name]
        broken = {low} if value <= low else {high} if value > high else {low, high}
        near = [(number, end) for number in numbers - ({abs(value)} - broken) for end in broken]
        if not any(abs(number - end) <= _NEAR * max(end, BOUNDS["wheel_diameter"][0]) for number, end in near):
            return f"It does not give, as a number, the end of the range that {value!r} breaks: {RANGES[name]}."
    return ""


def _over(one: float, other: float) -> float:
    """A quotient; NaN where there is none: the settings are a stranger's."""
    return one / other if other else math.nan


def _same(one: float, other: float) -> bool:
    return math.isclose(one, other, rel_tol=_RELATIVE, abs_tol=_ABSOLUTE) or (math.isnan(one) and math.isnan(other))


def command_of(rng: random.Random) -> tuple[str, float, list[float]]:
    """A command: its linear.x, by itself or as a share of max_velocity, and the other fields."""
    kind = rng.choice(("m/s", "of the limit"))
    size = rng.choice((1.0, -1.0, rng.uniform(0.2, 0.95), -rng.uniform(0.2, 0.95), 1.3, -1.3))
    return kind, size * (1.0 if kind == "of the limit" else BEYOND), [rng.uniform(-3, 3) for _ in FIELDS[1:]]


def twist_of(fields: list[float]) -> Twist:
    twist = Twist()
    for (of, axis), value in zip(FIELDS, fields, strict=True):
        setattr(getattr(twist, of), axis, value)
    return twist

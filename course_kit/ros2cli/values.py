"""Values typed as YAML put into a message, with errors that name the field."""

from __future__ import annotations

import math
import re
from typing import Any

from course_kit.ros.messages import ros_word, with_article
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.errors import CommandError

_INTEGER = re.compile(r"(u?)int(\d+)")
_ARRAY = re.compile(r"(?P<element>[^\[]+)\[(?P<length>\d+)\]")
_SEQUENCE = re.compile(r"sequence<(?P<element>.+?)(?:, (?P<bound>\d+))?>")
_BOUNDED_STRING = re.compile(r"w?string<(?P<bound>\d+)>")
_FLOATS = {"float": 3.4028234663852886e38, "double": math.inf}
_BYTE = 256


def load(text: str | None, what: str = "values") -> Any:
    """The YAML in `text`; an empty mapping for nothing.

    Raises:
        CommandError: it is no YAML; says where in one line.
    """
    import yaml

    try:
        loaded = yaml.safe_load(text) if text else {}
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f" in line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise CommandError(f"The {what} are not valid YAML: {error.problem}{place} of {text!r}.") from error
    except yaml.YAMLError as error:
        raise CommandError(f"The {what} are not valid YAML: {error}") from error
    return {} if loaded is None else loaded


def fill(message: Any, text: str | None, owner: str) -> None:
    """Set the fields of a message from YAML text such as '{a: 1, b: 2}'.

    Args:
        message: the message; fields that are not named keep their defaults.
        text: the YAML.
        owner: the message's ROS name, for errors.

    Raises:
        CommandError: no YAML, an unknown field, a value that does not fit; the field is named.
    """
    values = load(text)
    if not isinstance(values, dict):
        known = ", ".join(f"{name}: ..." for name in message.get_fields_and_field_types())
        raise CommandError(f"{owner} takes its fields as '{{{known}}}', not {text!r}.")
    _fill(message, values, owner, "")


def _fill(message: Any, values: dict[Any, Any], owner: str, path: str) -> None:
    known = message.get_fields_and_field_types()
    for name, value in values.items():
        field = f"{path}{name}"
        if name not in known:
            has = f"it has {', '.join(known)}" if known else "it has no fields"
            raise CommandError(f"{owner} has no field {field!r}; {has}.{did_you_mean(str(name), known)}")
        setattr(message, name, _fit(value, known[name], field, getattr(message, name)))


def _fit(value: Any, field_type: str, field: str, current: Any = None) -> Any:  # noqa: PLR0911 - a table of types
    """The value as the field takes it."""
    if listed := _ARRAY.fullmatch(field_type) or _SEQUENCE.fullmatch(field_type):
        return _fit_list(value, listed, field_type, field)
    if "/" in field_type:
        return _fit_message(value, field_type, field, current)
    if integer := _INTEGER.fullmatch(field_type):
        return _fit_integer(value, int(integer[2]), field, signed=not integer[1])
    if field_type in _FLOATS:
        return _fit_float(value, field_type, field)
    if field_type == "boolean":
        if value in (True, False) and not isinstance(value, float):
            return bool(value)
    elif field_type == "octet":
        if isinstance(value, int) and 0 <= value < _BYTE:
            return bytes([value])
    elif "string" in field_type:
        return _fit_text(value, field_type, field)
    raise _unfit(value, field_type, field)


def _fit_text(value: Any, field_type: str, field: str) -> str:
    if isinstance(value, (dict, list)) or value is None:
        raise _unfit(value, field_type, field)
    bounded = _BOUNDED_STRING.fullmatch(field_type)
    if bounded and len(str(value)) > int(bounded["bound"]):
        raise CommandError(f"The field {field!r} takes at most {bounded['bound']} characters, not {len(str(value))}.")
    return str(value)


def _fit_integer(value: Any, bits: int, field: str, *, signed: bool) -> int:
    field_type = f"{'' if signed else 'u'}int{bits}"
    if isinstance(value, str) and re.fullmatch(r"[+-]?\d+", value):
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int):
        raise _unfit(value, field_type, field)
    lowest, highest = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    if not lowest <= value <= highest:
        limits = f"{with_article(field_type)}, from {lowest} to {highest}"
        raise CommandError(f"The field {field!r} is {limits}; {value} is out of range.")
    return value


def _fit_float(value: Any, field_type: str, field: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise _unfit(value, field_type, field)
    try:
        number = float(value)  # YAML 1.1 takes 1e3 for a string
    except (ValueError, OverflowError):
        raise _unfit(value, field_type, field) from None
    if math.isfinite(number) and abs(number) > _FLOATS[field_type]:
        raise CommandError(f"The field {field!r} is a {ros_word(field_type)}; {value} is out of range.")
    return number


def _fit_list(value: Any, listed: re.Match[str], field_type: str, field: str) -> list[Any]:
    if not isinstance(value, list):
        raise _unfit(value, field_type, field)
    parts = listed.groupdict()
    if parts.get("length") and len(value) != int(parts["length"]):
        raise CommandError(f"The field {field!r} takes exactly {parts['length']} values, not {len(value)}.")
    if parts.get("bound") and len(value) > int(parts["bound"]):
        raise CommandError(f"The field {field!r} takes at most {parts['bound']} values, not {len(value)}.")
    return [_fit(element, parts["element"], f"{field}[{index}]") for index, element in enumerate(value)]


def _fit_message(value: Any, field_type: str, field: str, current: Any) -> Any:
    from course_kit import interfaces

    package, name = field_type.split("/")
    message = type(current)() if current is not None else interfaces.get_type(f"{package}/msg/{name}")()
    if value == "now" and field_type == "builtin_interfaces/Time":
        return _now(message)
    if value == "auto" and field_type == "std_msgs/Header":
        _now(message.stamp)
        return message
    if not isinstance(value, dict):
        raise _unfit(value, field_type, field)
    _fill(message, value, field_type, f"{field}.")
    return message


def _now(stamp: Any) -> Any:
    import time

    stamp.sec, stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
    return stamp


def _unfit(value: Any, field_type: str, field: str) -> CommandError:
    word = ros_word(field_type)
    kinds = {bool: "a boolean", int: "an integer", float: "a float", str: "a string", list: "a list", dict: "a mapping"}
    given = kinds.get(type(value), "nothing" if value is None else type(value).__name__)
    if listed := _ARRAY.fullmatch(field_type) or _SEQUENCE.fullmatch(field_type):
        word = f"list of {ros_word(listed['element'])}"
    return CommandError(f"The field {field!r} is {with_article(word)}; {value!r} is {given}.")

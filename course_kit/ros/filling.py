"""Fields put into messages, with errors that name the field: Python's values as they are, or what YAML makes of text.

rclpy checks fields with assertions, whose text names neither the message nor a way out.
"""

from __future__ import annotations

import base64
import math
import re
import textwrap
import time
from collections.abc import Mapping
from typing import Any

from course_kit.ros.messages import BadFieldError, Message, describe_type, is_message_type, ros_word, with_article
from course_kit.ros.names import nearest_name

Fields = Mapping[str, object]

_INTEGER = re.compile(r"(u?)int(\d+)")
_ARRAY = re.compile(r"(?P<element>[^\[]+)\[(?P<length>\d+)\]")
_SEQUENCE = re.compile(r"sequence<(?P<element>.+?)(?:, (?P<bound>\d+))?>")
_BOUNDED_STRING = re.compile(r"w?string<(?P<bound>\d+)>")
_FLOATS = {"float": 3.4028234663852886e38, "double": math.inf}
_HINTS = {
    "double": "a float such as 20.0",
    "float": "a float such as 20.0",
    "boolean": "True or False",
    "string": "a str such as 'text'",
    "wstring": "a str such as 'text'",
    "octet": "one byte such as b'a'",
}
_KINDS = {bool: "a boolean", int: "an integer", float: "a float", str: "a string", list: "a list", dict: "a mapping"}


def make_message(message_type: type[Message], fields: Fields, owner: str = "") -> Message:
    """Make a message with these fields; a dict stands for a message inside it. Errors call it `owner`, or its type."""
    message = message_type(check_fields=True)  # whatever ROS_PYTHON_CHECK_FIELDS was when the type was imported
    _put(message, fields, owner, "", from_yaml=False)
    return message


def fill_from_yaml(message: Message, fields: Fields, owner: str) -> None:
    """Set fields to what YAML makes of typed text: 1 is good for a float, '7' for an integer, "now" for a time."""
    _put(message, fields, owner, "", from_yaml=True)


def unknown_field(field: object, known: Fields, owner: str) -> str:
    """What to say about a field that a message does not have."""
    name, colon, rest = str(field).partition(":")
    if colon and name in known:
        return f"YAML wants a blank behind the colon: write {name}: {rest}, not {field}."
    if not known:
        return f"There is no field {field!r} in {owner}; it has none."
    near = nearest_name(str(field), known)
    meant = f" Did you mean {near!r}?" if near else ""
    return f"There is no field {field!r} in {owner}; it has {', '.join(known)}.{meant}"


def _put(message: Message, fields: Fields, owner: str, path: str, *, from_yaml: bool) -> None:
    known = message.get_fields_and_field_types()
    for name, value in fields.items():
        field = f"{path}{name}"
        if name not in known:
            raise BadFieldError(unknown_field(name, known, owner or describe_type(type(message))))
        now = getattr(message, name)
        if isinstance(value, dict) and is_message_type(type(now)):
            inner = type(now)(check_fields=True)
            _put(inner, value, f"{field}, {with_article(known[name])}", f"{field}.", from_yaml=from_yaml)
            fitted = inner
        else:
            fitted = fit_value(value, known[name], field, now) if from_yaml else value
        try:
            setattr(message, name, fitted)
        except (AssertionError, TypeError, ValueError, OverflowError) as error:
            owner = owner or describe_type(type(message))
            raise BadFieldError(explain_refusal(name, value, known[name], owner)) from error


def explain_refusal(field: object, value: object, field_type: str, owner: str) -> str:
    """Why the message has refused a value."""
    if field_type in _HINTS:
        wanted = _HINTS[field_type]
        if field_type in _FLOATS and isinstance(value, int) and not isinstance(value, bool):
            wanted = f"a float: write {float(value)}"
    elif _INTEGER.fullmatch(field_type):
        wanted = "a whole number in its range"
    else:
        example = "one that fits"
        if _list_type(field_type):
            example = "a list"
        elif "/" in field_type:
            example = _example(value, field_type)
        wanted = f"a value of that type, such as {example}"
    text = textwrap.shorten(repr(value), 40, placeholder="...")
    comma = "," if ", " in owner else ""  # after "position, a geometry_msgs/Point"
    return (
        f"The field {field!r} in {owner}{comma} has the type {ros_word(field_type)} and takes {wanted}; "
        f"it was given {text}, {with_article(type(value).__name__)}."
    )


def _example(value: object, field_type: str) -> str:
    """A value that a field of a message's type takes; of the same numbers, where a tuple or a list was given."""
    from course_kit import interfaces

    package, name = field_type.split("/")
    fields = list(interfaces.get_type(f"{package}/msg/{name}").get_fields_and_field_types())
    if not isinstance(value, (tuple, list)) or len(value) != len(fields):
        return "a dict of its fields"
    given = dict(zip(fields, value, strict=True))
    return f"{name}({', '.join(f'{field}={value!r}' for field, value in given.items())}) or {given!r}"


def _list_type(field_type: str) -> re.Match[str] | None:
    return _ARRAY.fullmatch(field_type) or _SEQUENCE.fullmatch(field_type)


def fit_value(value: Any, field_type: str, field: str, now: Any = None) -> Any:  # noqa: PLR0911 - a table of types
    """What a field of this type holds for a value that was typed; `field` is its name."""
    if listed := _list_type(field_type):
        return _fit_list(value, listed, field_type, field)
    if "/" in field_type:
        return _fit_message(value, field_type, field, now)
    if integer := _INTEGER.fullmatch(field_type):
        return _fit_integer(value, int(integer[2]), field, signed=not integer[1])
    if field_type in _FLOATS:
        return _fit_float(value, field_type, field)
    if field_type == "octet":
        return _fit_byte(value, field)
    if "string" in field_type:
        return _fit_text(value, field_type, field)
    if value in (True, False) and not isinstance(value, float):  # a boolean
        return bool(value)
    raise _explain_unfit(value, field_type, field)


def _fit_byte(value: object, field: str) -> bytes:
    """One byte, as YAML has it; ROS 2 refuses numbers."""
    if isinstance(value, bytes) and len(value) == 1:
        return value
    hint = ""
    if type(value) is int and value in range(256):
        hint = f" Write !!binary {base64.b64encode(bytes([value])).decode()} in its place, as in ROS 2."
    raise BadFieldError(f"{_explain_unfit(value, 'octet', field)}{hint}")


def _fit_text(value: object, field_type: str, field: str) -> str:
    if isinstance(value, (dict, list)) or value is None:
        raise _explain_unfit(value, field_type, field)
    bounded = _BOUNDED_STRING.fullmatch(field_type)
    if bounded and len(str(value)) > int(bounded["bound"]):
        raise BadFieldError(f"The field {field!r} takes at most {bounded['bound']} characters, not {len(str(value))}.")
    return str(value)


def _fit_integer(value: object, bits: int, field: str, *, signed: bool) -> int:
    field_type = f"{'' if signed else 'u'}int{bits}"
    if isinstance(value, str) and re.fullmatch(r"[+-]?\d+", value):
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int):
        raise _explain_unfit(value, field_type, field)
    lowest, highest = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    if not lowest <= value <= highest:
        limits = f"{with_article(field_type)}, from {lowest} to {highest}"
        raise BadFieldError(f"The field {field!r} is {limits}; {value} is out of range.")
    return value


def _fit_float(value: object, field_type: str, field: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise _explain_unfit(value, field_type, field)
    try:
        number = float(value)  # YAML 1.1 takes 1e3 for a string
    except (ValueError, OverflowError):
        raise _explain_unfit(value, field_type, field) from None
    if math.isfinite(number) and abs(number) > _FLOATS[field_type]:
        raise BadFieldError(f"The field {field!r} is a {ros_word(field_type)}; {value} is out of range.")
    return number


def _fit_list(value: object, listed: re.Match[str], field_type: str, field: str) -> list[object]:
    parts = listed.groupdict()
    if isinstance(value, bytes) and parts["element"] == "uint8":
        value = list(value)
    if not isinstance(value, list):
        raise _explain_unfit(value, field_type, field)
    if parts.get("length") and len(value) != int(parts["length"]):
        raise BadFieldError(f"The field {field!r} takes exactly {parts['length']} values, not {len(value)}.")
    if parts.get("bound") and len(value) > int(parts["bound"]):
        raise BadFieldError(f"The field {field!r} takes at most {parts['bound']} values, not {len(value)}.")
    return [fit_value(element, parts["element"], f"{field}[{index}]") for index, element in enumerate(value)]


def _fit_message(value: object, field_type: str, field: str, now: Message) -> Message:
    """A message that was not given by its fields; one in a list, by its fields."""
    from course_kit import interfaces

    package, name = field_type.split("/")
    message = type(now)() if now is not None else interfaces.get_type(f"{package}/msg/{name}")()
    if value == "now" and field_type == "builtin_interfaces/Time":
        return _set_to_now(message)
    if value == "auto" and field_type == "std_msgs/Header":
        _set_to_now(message.stamp)
        return message
    if not isinstance(value, dict):
        raise _explain_unfit(value, field_type, field)
    _put(message, value, f"{field}, {with_article(field_type)}", f"{field}.", from_yaml=True)
    return message


def _set_to_now(stamp: Message) -> Message:
    stamp.sec, stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
    return stamp


def _explain_unfit(value: object, field_type: str, field: str) -> BadFieldError:
    listed = _list_type(field_type)
    word = f"list of {ros_word(listed['element'])}" if listed else ros_word(field_type)
    given = _KINDS.get(type(value), "nothing" if value is None else type(value).__name__)
    return BadFieldError(f"The field {field!r} is {with_article(word)}; {value!r} is {given}.")

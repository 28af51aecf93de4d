"""Fields put into messages, with errors that name the field: Python's values as they are, or what YAML makes of text.

rclpy checks fields with assertions, whose text names neither the message nor a way out.
"""

from __future__ import annotations

import base64
import math
import re
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from course_kit.ros.messages import BadFieldError, Message, describe_type, is_message_type, ros_word, with_article
from course_kit.ros.names import nearest_name

if TYPE_CHECKING:
    from course_kit.interfaces.definition import FieldType

Fields = Mapping[str, object]

_FLOATS = {"float": 3.4028234663852886e38, "double": math.inf}
_HINTS = {
    "double": "a float such as 20.0",
    "float": "a float such as 20.0",
    "boolean": "True or False",
    "string": "a str such as 'text'",
    "wstring": "a str such as 'text'",
    "octet": "one byte such as b'a'",
    **{f"{sign}int{bits}": "a whole number in its range" for sign in ("", "u") for bits in (8, 16, 32, 64)},
}
_SHOWN = 40  # characters of a value that does not fit
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
    from course_kit.interfaces.message_fields import message_fields

    known = message.get_fields_and_field_types()
    kinds = {field.name: field.type for field in message_fields(type(message))} if from_yaml else {}
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
            fitted = fit_value(value, kinds[name], field, now) if from_yaml else value
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
    else:
        example = "one that fits"
        if field_type.startswith("sequence<") or field_type.endswith("]"):
            example = "a list"
        elif "/" in field_type:
            example = _example(value, field_type)
        wanted = f"a value of that type, such as {example}"
    whole = " ".join(repr(value).split())
    text = whole if len(whole) <= _SHOWN else f"{whole[:_SHOWN]}..."
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


def fit_value(value: Any, kind: FieldType, field: str, now: Any = None) -> Any:  # noqa: PLR0911 - a table of types
    """What a field of this type holds for a value that was typed; `field` is its name."""
    if kind.container:
        return _fit_list(value, kind, field)
    if kind.is_nested:
        return _fit_message(value, kind, field, now)
    if kind.is_string:
        return _fit_text(value, kind, field)
    if kind.base in _FLOATS:
        return _fit_float(value, kind, field)
    if kind.base == "octet":
        return _fit_byte(value, kind, field)
    if kind.primitive and (limits := kind.primitive.integer_range):
        return _fit_integer(value, kind, field, *limits)
    if value in (True, False) and not isinstance(value, float):  # a boolean
        return bool(value)
    raise _explain_unfit(value, kind, field)


def _fit_byte(value: object, kind: FieldType, field: str) -> bytes:
    """One byte, as YAML has it; ROS 2 refuses numbers."""
    if isinstance(value, bytes) and len(value) == 1:
        return value
    hint = ""
    if type(value) is int and value in range(256):
        hint = f" Write !!binary {base64.b64encode(bytes([value])).decode()} in its place, as in ROS 2."
    raise BadFieldError(f"{_explain_unfit(value, kind, field)}{hint}")


def _fit_text(value: object, kind: FieldType, field: str) -> str:
    if isinstance(value, (dict, list)) or value is None:
        raise _explain_unfit(value, kind, field)
    if kind.string_bound and len(str(value)) > kind.string_bound:
        raise BadFieldError(f"The field {field!r} takes at most {kind.string_bound} characters, not {len(str(value))}.")
    return str(value)


def _fit_integer(value: object, kind: FieldType, field: str, lowest: int, highest: int) -> int:
    if isinstance(value, str) and re.fullmatch(r"[+-]?\d+", value):
        value = int(value)
    if isinstance(value, bool) or not isinstance(value, int):
        raise _explain_unfit(value, kind, field)
    if not lowest <= value <= highest:
        limits = f"{with_article(kind.base)}, from {lowest} to {highest}"
        raise BadFieldError(f"The field {field!r} is {limits}; {value} is out of range.")
    return value


def _fit_float(value: object, kind: FieldType, field: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise _explain_unfit(value, kind, field)
    try:
        number = float(value)  # YAML 1.1 takes 1e3 for a string
    except (ValueError, OverflowError):
        raise _explain_unfit(value, kind, field) from None
    if math.isfinite(number) and abs(number) > _FLOATS[kind.base]:
        raise BadFieldError(f"The field {field!r} is a {ros_word(kind.base)}; {value} is out of range.")
    return number


def _fit_list(value: object, kind: FieldType, field: str) -> list[object]:
    if isinstance(value, bytes) and kind.base == "uint8":
        value = list(value)
    if not isinstance(value, list):
        raise _explain_unfit(value, kind, field)
    if kind.container == "array" and len(value) != kind.size:
        raise BadFieldError(f"The field {field!r} takes exactly {kind.size} values, not {len(value)}.")
    if kind.size and len(value) > kind.size:
        raise BadFieldError(f"The field {field!r} takes at most {kind.size} values, not {len(value)}.")
    return [fit_value(element, kind.element, f"{field}[{index}]") for index, element in enumerate(value)]


def _fit_message(value: object, kind: FieldType, field: str, now: Message) -> Message:
    """A message that was not given by its fields; one in a list, by its fields."""
    from course_kit import interfaces

    message = type(now)() if now is not None else interfaces.get_type(kind.base)()
    if value == "now" and str(kind) == "builtin_interfaces/Time":
        return _set_to_now(message)
    if value == "auto" and str(kind) == "std_msgs/Header":
        _set_to_now(message.stamp)
        return message
    if not isinstance(value, dict):
        raise _explain_unfit(value, kind, field)
    _put(message, value, f"{field}, {with_article(str(kind))}", f"{field}.", from_yaml=True)
    return message


def _set_to_now(stamp: Message) -> Message:
    stamp.sec, stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
    return stamp


def _explain_unfit(value: object, kind: FieldType, field: str) -> BadFieldError:
    word = f"list of {ros_word(str(kind.element))}" if kind.container else ros_word(str(kind))
    given = _KINDS.get(type(value), "nothing" if value is None else type(value).__name__)
    return BadFieldError(f"The field {field!r} is {with_article(word)}; {value!r} is {given}.")

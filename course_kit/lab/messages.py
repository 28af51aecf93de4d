"""Requests and messages out of keyword arguments, with errors that name the field.

rclpy checks fields with assertions, whose text names neither the message nor a way out.
"""

from __future__ import annotations

import re
import textwrap
from typing import Any

from course_kit.lab.errors import FieldError
from course_kit.ros.messages import is_message_type, ros_word, with_article
from course_kit.ros.names import nearest

_HINTS = {
    "double": "a float such as 20.0",
    "float": "a float such as 20.0",
    "boolean": "True or False",
    "string": "a str such as 'text'",
    "wstring": "a str such as 'text'",
    "octet": "one byte such as b'a'",
}


def build(message_type: Any, fields: dict[str, Any], owner: str) -> Any:
    """Make a message with these fields; a dict stands for a message inside it.

    Args:
        message_type: the class, e.g. `Trigger.Request`.
        fields: field names and values.
        owner: how to call the message in errors, e.g. "a std_srvs/srv/Trigger request".

    Raises:
        FieldError: an unknown field, or a value of the wrong type or out of range.
    """
    message = message_type(check_fields=True)  # whatever ROS_PYTHON_CHECK_FIELDS was when the type was imported
    known = message_type.get_fields_and_field_types()
    for name, value in fields.items():
        if name not in known:
            raise FieldError(_unknown(name, list(known), owner))
        _set(message, name, value, known[name], owner)
    return message


def _set(message: Any, name: str, value: Any, field_type: str, owner: str) -> None:
    if isinstance(value, dict) and is_message_type(type(getattr(message, name))):
        value = build(type(getattr(message, name)), value, f"{name}, a {field_type},")
    try:
        setattr(message, name, value)
    except (AssertionError, TypeError, ValueError, OverflowError) as error:
        raise FieldError(_unfit(name, value, field_type, owner)) from error


def _unknown(name: str, known: list[str], owner: str) -> str:
    if not known:
        return f"There is no field {name!r} in {owner}: it has no fields."
    near = nearest(name, known)
    meant = f" Did you mean {near!r}?" if near else ""
    return f"There is no field {name!r} in {owner}; it has {', '.join(known)}.{meant}"


def _unfit(name: str, value: Any, field_type: str, owner: str) -> str:
    if field_type in _HINTS:
        wanted = _HINTS[field_type]
        if field_type in {"double", "float"} and isinstance(value, int) and not isinstance(value, bool):
            wanted = f"a float: write {float(value)}"
    elif re.fullmatch(r"u?int\d+", field_type):
        wanted = "a whole number in its range"
    else:
        wanted = f"a value of that type, such as {_example(field_type)}"
    shown = textwrap.shorten(repr(value), 40, placeholder="...")
    return (
        f"The field {name!r} in {owner} has the type {ros_word(field_type)} and takes {wanted}; "
        f"it was given {shown}, {with_article(type(value).__name__)}."
    )


def _example(field_type: str) -> str:
    if "[" in field_type or field_type.startswith("sequence"):
        return "a list"
    return "a dict of its fields" if "/" in field_type else "one that fits"

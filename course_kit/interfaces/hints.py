"""What a person most likely meant, for the errors of the parser."""

from __future__ import annotations

import difflib
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

TYPE_EXAMPLES = (
    "expected a basic type such as int64, float64, bool or string, or a message such as geometry_msgs/Point."
)

# Names people bring along from ROS 1 and from programming languages.
OTHER_NAMES = {
    "time": "builtin_interfaces/Time (time was a basic type in ROS 1)",
    "duration": "builtin_interfaces/Duration (duration was a basic type in ROS 1)",
    "int": "int32 or int64",
    "integer": "int32 or int64",
    "long": "int64",
    "short": "int16",
    "unsigned": "uint32",
    "uint": "uint32",
    "float": "float32 or float64",
    "double": "float64",
    "number": "float64 or int64",
    "str": "string",
    "text": "string",
    "boolean": "bool",
    "bytes": "uint8[] or byte[]",
    "octet": "byte",
    "Header": "std_msgs/Header",
    "String": "string",
    "Bool": "bool",
    "list": "an array such as int32[]",
}


def nearest_name(name: str, candidates: Iterable[str], alike: float = 0.6) -> str | None:
    """The candidate that is written most like a name, None if none is; slips rarely change the first letter."""
    lowered = {candidate.lower(): candidate for candidate in candidates}
    found = difflib.get_close_matches(name.lower(), lowered, n=3, cutoff=alike)
    alike_at_first = [other for other in found if other[:1] == name[:1].lower()]
    return lowered[(alike_at_first or found)[0]] if found else None


def camel_case(name: str) -> str:
    """A name as interfaces are written: person_info -> PersonInfo; "" if nothing is left of it."""
    words = re.findall(r"[A-Za-z0-9]+", name)
    joined = "".join(word[0].upper() + word[1:] for word in words)
    return joined if joined[:1].isalpha() else ""


def for_unknown_type(text: str, name: str, primitives: Iterable[str]) -> str:
    """What was expected instead of an unknown type."""
    if name in primitives:
        return f"Expected the type first and the name second: {name} {text.rstrip(':;,')}"
    if text in OTHER_NAMES:
        return f"There is no type {text!r} in ROS 2: did you mean {OTHER_NAMES[text]}?"
    similar = nearest_name(text, primitives)
    if similar:
        return f"There is no type {text!r}: did you mean {similar}?"
    return f"There is no type {text!r}: {TYPE_EXAMPLES}"


def for_lonely_word(word: str) -> str:
    """What was expected instead of a line of one word."""
    if word.startswith("-"):
        return "Expected a type and a name; parts are separated by exactly three hyphens, ---."
    if "=" in word:
        return "Expected a type before the name of a constant, such as: string UNIT=metre"
    return f"Expected a type and a name, such as: {word} value" if word.isalnum() else "Expected a type and a name."


def for_field_name(name: str, rest: str) -> str:
    """What was expected instead of a name a field cannot have."""
    if name.endswith((";", ":")):
        return f"Expected the name alone, without {name[-1]!r}."
    if "," in name or rest.startswith(","):
        return "Expected one field a line, each with its own type."
    spaced = re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name)
    suggestion = "_".join(re.findall(r"[a-z0-9]+", spaced.lower()))  # max_speed for maxSpeed
    example = f", such as {suggestion}" if suggestion[:1].isalpha() else ""
    return (
        f"{name!r} cannot name a field: expected lower-case letters, digits and single underscores, "
        f"starting with a letter{example}."
    )

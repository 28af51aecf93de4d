"""Constants and default values as they are written in definitions."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from course_kit.interfaces.field_types import FieldType

_IDL_ESCAPE = re.compile(r"\\[ntvbrfa\\?'\"]|\\[0-7]{1,3}|\\x[0-9a-fA-F]{1,2}")
_PYTHON_ESCAPE = re.compile(
    r"\\(?:[abfnrtv\\'\"]|[0-3]?[0-7]{1,2}|x[0-9a-fA-F]{0,2}|u[0-9a-fA-F]{0,4}|U[0-9a-fA-F]{0,8}|N(?:\{[^}]*\})?|$)"
)
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}
_QUOTED = re.compile(r"""\s*(?:"((?:[^"\\]|\\.)*)"|'((?:[^'\\]|\\.)*)'|([^,"'\s][^,]*))\s*(?:,|$)""")


class LiteralError(ValueError):
    """The text is not a value of the type; the message says what would be."""


def parse_value(kind: FieldType, text: str) -> Any:
    """Read a value of a basic type, or a list of them for an array."""
    if not kind.container:
        return _single(kind, text)
    if not (text.startswith("[") and text.endswith("]")):
        raise LiteralError(f"Expected the values of an array in brackets, such as [1, 2, 3], not {text!r}.")
    inside = text[1:-1]
    elements = _string_elements(inside) if kind.is_string else [part.strip() for part in inside.split(",")]
    if not inside:
        elements = []
    if kind.container == "array" and len(elements) != kind.size:
        raise LiteralError(f"Expected exactly {kind.size} values in the brackets, not {len(elements)}.")
    if kind.container == "sequence" and kind.size and len(elements) > kind.size:
        raise LiteralError(f"Expected at most {kind.size} values in the brackets, not {len(elements)}.")
    return [_element(kind, element) for element in elements]


def _element(kind: FieldType, text: str) -> bool | int | float | str:
    if kind.is_string:
        return _python_decoded(_bounded(kind, text))
    return _single(kind.element, text)


def _single(kind: FieldType, text: str) -> bool | int | float | str:
    primitive = kind.primitive
    if primitive is None:
        return _decoded(_bounded(kind, _unquoted(text)))
    if primitive.python is bool:
        if text.lower() not in _BOOLEANS:
            raise LiteralError(f"Expected true or false, not {text!r}.")
        return _BOOLEANS[text.lower()]
    if primitive.python is float:
        return _float(text)
    return _integer(text, *(primitive.integer_range or (0, 255)))


def _float(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise LiteralError(f"Expected a number such as 1.5, not {text!r}.") from None


def _integer(text: str, smallest: int, largest: int) -> int:
    value = None
    for base in (10, 0):  # base 0 knows 0x, 0o and 0b
        try:
            value = int(text, base)
            break
        except ValueError:
            continue
    if value is None or not smallest <= value <= largest:
        raise LiteralError(f"Expected a whole number from {smallest} to {largest}, not {text!r}.")
    return value


def _unquoted(text: str) -> str:
    for quote in "\"'":
        if len(text) > 1 and text.startswith(quote) and text.endswith(quote):
            inside = text[1:-1]
            if re.search(rf"(?<!\\){quote}", inside):
                raise LiteralError(f"Expected {quote} inside the quotes to be written \\{quote}.")
            return inside.replace(f"\\{quote}", quote)
    if text[:1] in ("'", '"'):
        raise LiteralError(f"Expected the text to end with {text[0]}, as it begins.")
    return text


def _bounded(kind: FieldType, text: str) -> str:
    if kind.string_bound and len(text) > kind.string_bound:
        raise LiteralError(f"Expected at most {kind.string_bound} characters, not the {len(text)} of {text!r}.")
    return text


def _decoded(text: str) -> str:
    r"""The text that `\t`, `\x41` and the like stand for, as it comes out of the two steps of rosidl."""
    idl = _python_decoded(text)
    return re.sub(r'\\(["\\])', r"\1", _IDL_ESCAPE.sub(lambda part: _python_decoded(part[0]), idl))


def _python_decoded(text: str) -> str:
    try:
        return _PYTHON_ESCAPE.sub(lambda part: part[0].encode().decode("unicode_escape"), text)
    except UnicodeDecodeError as error:
        begun = error.object[error.start : error.end].decode()
        raise LiteralError(
            f"Expected an escape such as \\t or \\x41, not {begun}. A backslash itself is written \\\\\\\\."
        ) from None


def _string_elements(text: str) -> list[str]:
    elements, at = [], 0
    while at < len(text):
        match = _QUOTED.match(text, at)
        if not match:
            raise LiteralError(f"Expected texts separated by commas, each in quotes, not {text[at:].strip()!r}.")
        double, single, bare = match.groups()
        if double is not None:
            elements.append(double.replace('\\"', '"'))
        else:
            elements.append(single.replace("\\'", "'") if single is not None else bare.rstrip())
        at = match.end()
    return elements

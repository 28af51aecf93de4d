"""Reads .msg, .srv and .action text; every fault is reported with its line and what was expected there.

The rules are those of rosidl_adapter in Jazzy, with two additions: what could never be built or imported later (a field
called `class`) is refused at once, and common leading blanks are taken off.
"""

from __future__ import annotations

import keyword
import re
import textwrap
from typing import Any, NoReturn

from course_kit.interfaces import hints
from course_kit.interfaces.definition import (
    ActionDefinition,
    Constant,
    Definition,
    Field,
    FieldType,
    Line,
    MessageDefinition,
    ServiceDefinition,
    TypeName,
    module_name,
)
from course_kit.interfaces.errors import InterfaceDefinitionError

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
        return _read_single_value(kind, text)
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
        return _python_decoded(_require_bound(kind, text))
    return _read_single_value(kind.element, text)


def _read_single_value(kind: FieldType, text: str) -> bool | int | float | str:
    primitive = kind.primitive
    if primitive is None:
        return _decode_escapes(_require_bound(kind, _strip_quotes(text)))
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


def _strip_quotes(text: str) -> str:
    for quote in "\"'":
        if len(text) > 1 and text.startswith(quote) and text.endswith(quote):
            inside = text[1:-1]
            if re.search(rf"(?<!\\){quote}", inside):
                raise LiteralError(f"Expected {quote} inside the quotes to be written \\{quote}.")
            return inside.replace(f"\\{quote}", quote)
    if text[:1] in ("'", '"'):
        raise LiteralError(f"Expected the text to end with {text[0]}, as it begins.")
    return text


def _require_bound(kind: FieldType, text: str) -> str:
    if kind.string_bound and len(text) > kind.string_bound:
        raise LiteralError(f"Expected at most {kind.string_bound} characters, not the {len(text)} of {text!r}.")
    return text


def _decode_escapes(text: str) -> str:
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


# What .msg calls the basic types; `char` and `byte` are historical names.
PRIMITIVE_NAMES = {
    "bool": "boolean",
    "byte": "octet",
    "char": "uint8",
    "float32": "float",
    "float64": "double",
    **{name: name for bits in (8, 16, 32, 64) for name in (f"int{bits}", f"uint{bits}")},
    "string": "string",
    "wstring": "wstring",
}
PARTS = {"msg": ("message",), "srv": ("request", "response"), "action": ("goal", "result", "feedback")}
SEPARATOR = "---"

_LOWER_NAME = re.compile(r"[a-z](_?[a-z0-9])*")
_UPPER_NAME = re.compile(r"[A-Z](_?[A-Z0-9])*")
_TYPE_NAME = re.compile(r"[A-Z][A-Za-z0-9]*")
_FIELD_TYPE = re.compile(r"(?P<base>[^\[\]<]+)(?P<text_bound><=[^\[\]]*)?(?P<brackets>\[(?P<size>[^\[\]]*)\])?")
_TAKEN_NAMES = {"check_fields", "get_fields_and_field_types"}


def parse_type_name(text: str) -> TypeName:
    """Read a full interface name such as "my_interfaces/srv/PersonInfo"."""
    parts = text.split("/")
    example = "expected package/folder/Name with the folder msg, srv or action, such as my_interfaces/srv/PersonInfo."
    if len(parts) != 3 or parts[1] not in PARTS:  # noqa: PLR2004
        raise InterfaceDefinitionError(text, 0, "", f"This is not a full interface name: {example}")
    package, kind, name = parts
    if not _LOWER_NAME.fullmatch(package) or keyword.iskeyword(package):
        rule = "lower-case letters, digits and single underscores, starting with a letter"
        raise InterfaceDefinitionError(text, 0, "", f"{package!r} cannot name a package: expected {rule}.")
    if not _TYPE_NAME.fullmatch(name) or keyword.iskeyword(name):
        suggestion = f", such as {hints.camel_case(name)}" if hints.camel_case(name) else ""
        rule = f"letters and digits, starting with a capital letter{suggestion}"
        raise InterfaceDefinitionError(text, 0, "", f"{name!r} cannot name an interface: expected {rule}.")
    return TypeName(package, kind, name)


def parse_definition(type_name: str, text: str) -> Definition:
    """Read the definition of an interface."""
    name = parse_type_name(type_name)
    sections = _split(name, text)
    module = module_name(name.name)
    if name.kind == "msg":
        return _Section(name, name, sections[0]).parse(module)
    suffixes = [f"_{part.capitalize()}" for part in PARTS[name.kind]]
    messages = [
        _Section(name, name._replace(name=name.name + suffix), lines).parse(module)
        for suffix, lines in zip(suffixes, sections, strict=True)
    ]
    if name.kind == "srv":
        return ServiceDefinition(name, module, *messages)
    return ActionDefinition(name, module, *messages)


def _split(name: TypeName, text: str) -> list[list[Line]]:
    """The lines of each part of the definition."""
    lines = [Line(i, line) for i, line in enumerate(textwrap.dedent(text).replace("\t", " ").splitlines(), 1)]
    sections: list[list[Line]] = [[]]
    separators = []
    for line in lines:
        if line.text.rstrip() == SEPARATOR != line.text:
            blank = f"Expected '{SEPARATOR}' alone: a blank behind it makes it something else for ROS 2."
            raise InterfaceDefinitionError(str(name), line.number, line.text, blank)
        if line.text == SEPARATOR:
            sections.append([])
            separators.append(line)
        else:
            sections[-1].append(line)
    parts = PARTS[name.kind]
    if len(sections) == len(parts):
        return sections
    wanted = len(parts) - 1
    if len(separators) > wanted:
        culprit = separators[wanted]
        extra = f"A .{name.kind} has {_count(wanted)} of '{SEPARATOR}' ({_order(parts)}); this one is too many."
        raise InterfaceDefinitionError(str(name), culprit.number, culprit.text, extra)
    for line in lines:
        if re.fullmatch(r"\s*-+\s*", line.text) and line not in separators:
            expected = f"Expected '{SEPARATOR}', three hyphens at the start of the line, between {_order(parts)}."
            raise InterfaceDefinitionError(str(name), line.number, line.text, expected)
    missing = f"A .{name.kind} needs {_count(wanted)} of '{SEPARATOR}' ({_order(parts)}); found {len(separators)}."
    raise InterfaceDefinitionError(str(name), 0, "", missing)


def _count(wanted: int) -> str:
    return {0: "no line", 1: "exactly one line", 2: "exactly two lines"}[wanted]


def _order(parts: tuple[str, ...]) -> str:
    return f", {SEPARATOR}, ".join(parts)


class _Section:
    """Reads the lines of one message, or of one part of a service or action."""

    def __init__(self, owner: TypeName, name: TypeName, lines: list[Line]) -> None:
        self._owner, self._name, self._lines = owner, name, lines
        self._seen: dict[str, Line] = {}

    def parse(self, module: str) -> MessageDefinition:
        fields, constants = [], []
        for line in self._lines:
            content = line.text.partition("#")[0].rstrip()
            if not content:
                continue
            if content[0] == " ":
                self._fail(line, "Expected a type at the very start of the line, without blanks before it.")
            found = self._parse_line(line, content)
            if isinstance(found, Field):
                fields.append(found)
            else:
                constants.append(found)
        return MessageDefinition(self._name, module, tuple(fields), tuple(constants))

    def _parse_line(self, line: Line, content: str) -> Field | Constant:
        type_text, _, rest = content.partition(" ")
        rest = rest.lstrip()
        if not rest:
            self._fail(line, hints.for_lonely_word(type_text))
        if "=" in rest:
            name, _, value = rest.partition("=")
            return self._constant(line, type_text, name.rstrip(), value.lstrip())
        name, _, value = rest.partition(" ")
        return self._field(line, type_text, name, value.lstrip())

    def _constant(self, line: Line, type_text: str, name: str, value: str) -> Constant:
        if type_text not in PRIMITIVE_NAMES:
            kind = self._type(line, type_text, name)
            self._fail(line, f"A constant has a basic type such as int32 or string; {kind} is not one.")
        if not _UPPER_NAME.fullmatch(name):
            example = re.sub(r"\W+", "_", name).strip("_").upper() or "MAX_SPEED"
            self._fail(line, f"{name!r} cannot name a constant: expected capitals, such as {example}.")
        self._remember(line, name, "constant")
        kind = FieldType(PRIMITIVE_NAMES[type_text])
        return Constant(name, kind, self._value(line, kind, value))

    def _field(self, line: Line, type_text: str, name: str, value: str) -> Field:
        kind = self._type(line, type_text, name)
        if not _LOWER_NAME.fullmatch(name) or value.startswith(","):
            self._fail(line, hints.for_field_name(name, value))
        if keyword.iskeyword(name) or name in _TAKEN_NAMES:
            self._fail(line, f"A field cannot be called {name!r}, which has a meaning in Python: try {name}_value.")
        self._remember(line, name, "field")
        if not value:
            return Field(name, kind, None, line)
        if kind.is_nested:
            self._fail(line, f"Only basic types can have a default value; nothing is expected behind {name!r}.")
        return Field(name, kind, self._value(line, kind, value), line)

    def _type(self, line: Line, text: str, name: str) -> FieldType:
        match = _FIELD_TYPE.fullmatch(text)
        if not match:
            self._fail(line, f"{text!r} is not a type: {hints.TYPE_EXAMPLES}")
        base, bound = self._base(line, match["base"], name), 0
        if match["text_bound"] is not None:
            if base not in ("string", "wstring"):
                self._fail(line, f"Only string and wstring take a bound like {match['text_bound']!r}.")
            bound = self._read_size(line, match["text_bound"][2:], "the most characters, such as string<=20")
        if match["brackets"] is None:
            return FieldType(base, string_bound=bound)
        size = match["size"].strip()
        if not size:
            # rosidl_parser takes the bound of wide strings, and only theirs, for that of the sequence as well.
            return FieldType(base, "sequence", bound if base == "wstring" else 0, bound)
        container = "sequence" if size.startswith("<=") else "array"
        count = self._read_size(line, size.removeprefix("<="), "a number of elements, such as [3] or [<=10], or []")
        return FieldType(base, container, count, bound)

    def _base(self, line: Line, text: str, name: str) -> str:
        if text in PRIMITIVE_NAMES:
            return PRIMITIVE_NAMES[text]
        package, slash, type_name = text.rpartition("/")
        package = package or self._owner.package
        if not slash and not text[:1].isupper():
            self._fail(line, hints.for_unknown_type(text, name, PRIMITIVE_NAMES))
        if "/" in package:
            short = f"{package.partition('/')[0]}/{type_name}"
            self._fail(line, f"Expected a message type as package/Name, without a folder between: {short}")
        if not _LOWER_NAME.fullmatch(package) or not _TYPE_NAME.fullmatch(type_name):
            self._fail(line, f"{text!r} is not a type: {hints.TYPE_EXAMPLES}")
        return f"{package}/msg/{type_name}"

    def _read_size(self, line: Line, text: str, expected: str) -> int:
        if not text.strip().isascii() or not text.strip().isdigit() or not 0 < int(text) < 2**32:
            self._fail(line, f"{text!r} is not a size: expected {expected}.")
        return int(text)

    def _value(self, line: Line, kind: FieldType, text: str) -> object:
        try:
            return parse_value(kind, text)
        except LiteralError as error:
            cut = " (A # starts a comment, even inside quotes.)" if "#" in line.text and text[:1] in ("'", '"') else ""
            self._fail(line, f"{error}{cut}")

    def _remember(self, line: Line, name: str, what: str) -> None:
        before = self._seen.setdefault(f"{what} {name}", line)
        if before is not line:
            self._fail(line, f"There is a {what} {name!r} already, in line {before.number}: expected another name.")

    def _fail(self, line: Line, expected: str) -> NoReturn:
        raise InterfaceDefinitionError(str(self._owner), line.number, line.text, expected)

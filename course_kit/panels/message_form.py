"""A message as a form: its fields for a page to draw, and what was typed there as a message again.

Numbers travel between page and kernel as text, since JavaScript's lose digits above 2**53.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import yaml

from course_kit.interfaces.comments import comments_of
from course_kit.interfaces.message_fields import MessageField, message_fields
from course_kit.ros.filling import fit_value
from course_kit.ros.messages import BadFieldError, is_message_type, ros_word
from course_kit.ros.showing import copy_message

if TYPE_CHECKING:
    from course_kit.interfaces.definition import FieldType
    from course_kit.ros.messages import Message

Entry = dict[str, Any]  # one field, as the page draws it
Values = dict[str, Any]  # path of a field -> the text in it, or whether it is ticked


class FormError(ValueError):
    """Some fields hold what they cannot take."""

    def __init__(self, fields: dict[str, str]) -> None:
        self.fields = fields
        super().__init__(" ".join(f"{path}: {reason[:1].lower()}{reason[1:]}" for path, reason in fields.items()))


class MessageForm:
    """The form of one message type."""

    def __init__(self, message_type: type[Message]) -> None:
        self._type = message_type

    def entries(self) -> list[Entry]:
        """What to draw, from top to bottom."""
        return self._message(self._type(), "")

    def defaults(self) -> Values:
        """What the fields hold at first."""
        return {entry["path"]: entry["default"] for entry in _flatten_entries(self.entries()) if "default" in entry}

    def read(self, values: Values) -> Message:
        """The message these values make; fields without one keep their defaults."""
        wrong: dict[str, str] = {}
        known = self.defaults()
        for path in values:
            if path not in known:
                wrong[path] = f"There is no such field; there are {', '.join(known) or 'none'}."
        message = self._read(self._type, "", values, wrong)
        if wrong:
            raise FormError(wrong)
        return message

    def _message(self, message: Message, prefix: str) -> list[Entry]:
        constants, comments = _constants(type(message)), comments_of(type(message))
        entries = [
            self._entry(f"{prefix}{field.name}", field, getattr(message, field.name), _choices(field, constants))
            for field in message_fields(type(message))
        ]
        for entry in entries:
            if comment := comments.get(entry["name"]):
                entry["comment"] = comment
        return entries

    def _entry(self, path: str, field: MessageField, default: Any, choices: list[dict[str, str]]) -> Entry:
        kind = field.type
        entry: Entry = {"path": path, "name": path.rpartition(".")[2], "type": type_in_words(kind), "choices": choices}
        if kind.is_nested and not kind.container:
            return {**entry, "kind": "group", "fields": self._message(default, f"{path}.")}
        if kind.base == "boolean" and not kind.container:
            return {**entry, "kind": "flag", "default": bool(default)}
        return {**entry, "kind": "line", "hint": _hint(kind), "default": _as_text(default)}

    def _read(self, message_type: type[Message], prefix: str, values: Values, wrong: dict[str, str]) -> Message:
        message = message_type(check_fields=True)
        for field in message_fields(message_type):
            path = f"{prefix}{field.name}"
            try:
                setattr(message, field.name, self._value(path, field, values, wrong, getattr(message, field.name)))
            except ValueError as error:
                wrong[path] = str(error)
        return message

    def _value(self, path: str, field: MessageField, values: Values, wrong: dict[str, str], now: Any) -> Any:
        kind = field.type
        if field.nested is not None and not kind.container:
            return self._read(field.nested, f"{path}.", values, wrong)
        if values.get(path, _as_text(now)) == _as_text(now):  # as it was
            return now
        return _parse_entry(kind, values[path], path)


def type_in_words(kind: FieldType) -> str:
    """A type as a definition spells it, such as "float64[3]"."""
    value = kind.base.replace("/msg/", "/") if kind.is_nested else ros_word(kind.base)
    if kind.string_bound:
        value += f"<={kind.string_bound}"
    if kind.container == "array":
        return f"{value}[{kind.size}]"
    return f"{value}[{f'<={kind.size}' if kind.size else ''}]" if kind.container else value


def fields_in_words(message_type: type[Message]) -> str:
    """The fields of a message in one line: "a (int64), b (int64)"; "none" without any."""
    return ", ".join(f"{field.name} ({type_in_words(field.type)})" for field in message_fields(message_type)) or "none"


def _hint(kind: FieldType) -> str:
    if kind.container:
        how_many = f"{kind.size} " if kind.container == "array" else f"up to {kind.size} " if kind.size else ""
        words = {"boolean": "values true or false", "float": "numbers", "double": "numbers"}
        if kind.is_nested:
            return f"{how_many}messages, with commas, each as {{field: value, ...}}"
        return f"{how_many}{'texts' if kind.is_string else words.get(kind.base, 'whole numbers')}, with commas"
    if kind.is_string:
        return f"text, up to {kind.string_bound} characters" if kind.string_bound else "text"
    return "a number" if kind.base in {"float", "double"} else "a whole number"


def _parse_entry(kind: FieldType, typed: Any, path: str) -> Any:
    wanted = kind._replace(base="uint8") if kind.base == "octet" else kind  # a byte is typed as a number
    value = typed if kind.is_string or isinstance(typed, bool) else str(typed).strip()
    try:
        if kind.container:  # as on the command line: YAML; its brackets may be left out
            text = str(typed).strip()
            value = yaml.safe_load(text if text.startswith("[") else f"[{text}]")
        fitted = fit_value(value, wanted, path)
    except (BadFieldError, yaml.YAMLError):
        limits = kind.primitive and kind.primitive.integer_range
        spelled = f"{type_in_words(kind)}, from {limits[0]} to {limits[1]}" if limits else type_in_words(kind)
        raise ValueError(f"Expected {_hint(kind)} ({spelled}), not {typed!r}.") from None
    if kind.base != "octet":
        return fitted
    return [bytes([number]) for number in fitted] if kind.container else bytes([fitted])


def _constants(message_type: type[Message]) -> dict[str, object]:
    """The constants of a message class; compiled and live ones keep them in the same way, on the metaclass."""
    return {
        name: getattr(message_type, name)
        for name, value in vars(type(message_type)).items()
        if isinstance(value, property) and not name.endswith("__DEFAULT")
    }


def _choices(field: MessageField, constants: dict[str, object]) -> list[dict[str, str]]:
    """The constants that a field can hold."""
    return [
        {"name": name, "value": str(value[0] if isinstance(value, bytes) else value)}
        for name, value in constants.items()
        if _fits(field.type, value)
    ]


def _fits(kind: FieldType, value: object) -> bool:
    if kind.container:
        return False
    if kind.is_string:
        return isinstance(value, str) and (not kind.string_bound or len(value) <= kind.string_bound)
    primitive = kind.primitive
    if primitive is None or type(value) is not primitive.python:
        return False
    limits = primitive.integer_range
    return limits is None or value in range(limits[0], limits[1] + 1)


def _flatten_entries(entries: list[Entry]) -> list[Entry]:
    return [field for entry in entries for field in (entry, *_flatten_entries(entry.get("fields", [])))]


def _as_text(value: Any) -> Any:
    if isinstance(value, (str, bool)):
        return value
    if isinstance(value, bytes):
        return str(value[0])
    if hasattr(value, "tolist"):  # numpy.ndarray, array.array
        value = value.tolist()
    if isinstance(value, list) and value and is_message_type(type(value[0])):
        return yaml.safe_dump(copy_message(value), default_flow_style=True, sort_keys=False, width=10_000).strip()
    return ", ".join(str(_as_text(item)) for item in value) if isinstance(value, list) else str(value)

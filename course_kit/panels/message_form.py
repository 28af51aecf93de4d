"""A message as a form: its fields for a page to draw, and what was typed there as a message again.

Numbers travel between page and kernel as text, since JavaScript's lose digits above 2**53.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.interfaces.comments import comments_of
from course_kit.interfaces.message_fields import MessageField, message_fields
from course_kit.ros.filling import fit_value
from course_kit.ros.messages import BadFieldError, ros_word

if TYPE_CHECKING:
    from ipywidgets import Widget

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
        self._lengths: dict[str, int] = {}

    def entries(self) -> list[Entry]:
        """What to draw, from top to bottom."""
        return self._message(self._type(), "")

    def defaults(self) -> Values:
        """What the fields hold at first."""
        return {entry["path"]: entry["default"] for entry in _flat(self.entries()) if "default" in entry}

    def resize(self, path: str, change: int) -> None:
        """Let a list have `change` elements more, within its bounds."""
        entry = next((one for one in _flat(self.entries()) if one["path"] == path and one["kind"] == "list"), None)
        if entry is not None:
            wanted = max(0, len(entry["fields"]) + change)
            self._lengths[path] = min(wanted, entry["most"] or wanted)

    def type_in(self, page: Widget, wish: dict[str, Any]) -> None:
        """Take over what a page has sent: what was typed, and a list that is to grow or shrink."""
        page.values = {**page.values, **wish.get("values", {})}
        if wish.get("do") in {"add", "remove"}:
            self.resize(wish["path"], 1 if wish["do"] == "add" else -1)
            known = page.values
            with page.hold_sync():  # in one message: whoever sees the new field may type into it at once
                page.entries = self.entries()
                page.values = {path: known.get(path, value) for path, value in self.defaults().items()}

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
        fields = message_fields(type(message))
        constants, comments = _constants(type(message)), comments_of(type(message))
        entries = [
            self._entry(
                f"{prefix}{field.name}", field, getattr(message, field.name), _choices(field, fields, constants)
            )
            for field in fields
        ]
        for entry in entries:
            if comment := comments.get(entry["name"]):
                entry["comment"] = comment
        return entries

    def _entry(self, path: str, field: MessageField, default: Any, choices: list[dict[str, str]]) -> Entry:
        kind = field.type
        entry: Entry = {"path": path, "name": path.rpartition(".")[2], "type": type_in_words(kind), "choices": choices}
        if _is_list_of_parts(kind):
            element = field._replace(type=kind.element)
            count = self._length(path, kind, default)
            firsts = [*default[:count], *((field.nested or str)() for _ in range(count - len(default)))]
            parts = [self._entry(f"{path}[{n}]", element, first, choices) for n, first in enumerate(firsts)]
            grows = kind.container == "sequence"
            return {**entry, "kind": "list", "fields": parts, "grows": grows, "most": kind.size, "choices": []}
        if kind.is_nested:
            return {**entry, "kind": "group", "fields": self._message(default, f"{path}.")}
        if kind.base == "boolean" and not kind.container:
            return {**entry, "kind": "flag", "default": bool(default)}
        return {**entry, "kind": "line", "hint": _hint(kind), "default": _as_text(default)}

    def _length(self, path: str, kind: FieldType, default: Any) -> int:
        return kind.size if kind.container == "array" else self._lengths.get(path, len(default))

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
        if _is_list_of_parts(kind):
            element = field._replace(type=kind.element)
            count = self._length(path, kind, now)
            parts = [*now[:count], *[""] * (count - len(now))]
            return [self._value(f"{path}[{n}]", element, values, wrong, part) for n, part in enumerate(parts)]
        if kind.is_nested and field.nested is not None:
            return self._read(field.nested, f"{path}.", values, wrong)
        return _parsed(kind, values[path], path) if path in values else now


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


def _is_list_of_parts(kind: FieldType) -> bool:
    """Whether each element has its own place in the form."""
    return bool(kind.container) and (kind.is_nested or kind.is_string)


def _hint(kind: FieldType) -> str:
    if kind.container:
        how_many = f"{kind.size} " if kind.container == "array" else f"up to {kind.size} " if kind.size else ""
        words = {"boolean": "values true or false", "float": "numbers", "double": "numbers"}
        return f"{how_many}{words.get(kind.base, 'whole numbers')}, with commas"
    if kind.is_string:
        return f"text, up to {kind.string_bound} characters" if kind.string_bound else "text"
    return "a number" if kind.base in {"float", "double"} else "a whole number"


def _parsed(kind: FieldType, typed: Any, path: str) -> Any:
    text = ", ".join(map(str, typed)) if isinstance(typed, (list, tuple)) else str(typed)
    value: object = text if kind.is_string else _word(text)
    if kind.container:
        inside = text.strip("[] ")
        value = [_word(part) for part in inside.split(",")] if inside else []
    field_type = str(kind).replace("octet", "uint8")  # a byte is typed as a number
    try:
        fitted = fit_value(value, field_type, path)
    except BadFieldError:
        limits = kind.primitive and kind.primitive.integer_range
        spelled = f"{type_in_words(kind)}, from {limits[0]} to {limits[1]}" if limits else type_in_words(kind)
        raise ValueError(f"Expected {_hint(kind)} ({spelled}), not {text!r}.") from None
    if kind.base != "octet":
        return fitted
    return [bytes([one]) for one in fitted] if kind.container else bytes([fitted])


def _word(text: str) -> bool | str:
    """One value between commas."""
    return {"true": True, "false": False}.get(text.strip().lower(), text.strip())


def _constants(message_type: type[Message]) -> dict[str, object]:
    """The constants of a message class; compiled and live ones keep them in the same way, on the metaclass."""
    return {
        name: getattr(message_type, name)
        for name, value in vars(type(message_type)).items()
        if isinstance(value, property) and not name.endswith("__DEFAULT")
    }


def _choices(
    field: MessageField, fields: tuple[MessageField, ...], constants: dict[str, object]
) -> list[dict[str, str]]:
    """The constants that a field may be meant to have."""
    owners = {one.name.upper(): one for one in fields}
    return [
        {"name": name, "value": str(value[0] if isinstance(value, bytes) else value)}
        for name, value in constants.items()
        if _fits(field.type, value) and _owner(name, owners) in {None, field}
    ]


def _owner(constant: str, owners: dict[str, MessageField]) -> MessageField | None:
    return next((field for name, field in owners.items() if constant.startswith(f"{name}_")), None)


def _fits(kind: FieldType, value: object) -> bool:
    if kind.is_string:
        return isinstance(value, str) and (not kind.string_bound or len(value) <= kind.string_bound)
    primitive = kind.primitive
    if primitive is None or kind.container or type(value) is not primitive.python:
        return False
    limits = primitive.integer_range
    return limits is None or value in range(limits[0], limits[1] + 1)


def _flat(entries: list[Entry]) -> list[Entry]:
    return [one for entry in entries for one in (entry, *_flat(entry.get("fields", [])))]


def _as_text(value: Any) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, bytes):
        return str(value[0])
    if hasattr(value, "tolist"):  # numpy.ndarray, array.array
        value = value.tolist()
    return ", ".join(_as_text(one) for one in value) if isinstance(value, list) else str(value)

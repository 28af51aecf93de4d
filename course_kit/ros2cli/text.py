"""Messages as text, the way `ros2 topic echo` and its relatives print them."""

from __future__ import annotations

import array
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

_END = "...\n"
TRUNCATE = 128  # elements and characters, by default


class Layout:
    """How much of a message is shown."""

    def __init__(
        self, *, truncate: int | None = TRUNCATE, arrays: bool = True, strings: bool = True, flow: bool = False
    ) -> None:
        self.truncate, self.arrays, self.strings, self.flow = truncate, arrays, strings, flow


WHOLE = Layout(truncate=None)


def to_yaml(value: object, layout: Layout = WHOLE) -> str:
    """A message, or one field of it, as YAML with the fields in their order; ends with a line break."""
    return dump_yaml(to_plain(value, layout), layout)


def dump_yaml(plain: object, layout: Layout = WHOLE) -> str:
    """Mappings, lists and scalars as YAML in their order; ends with a line break."""
    import sys

    import yaml

    text: str = yaml.safe_dump(
        plain,
        allow_unicode=True,
        width=sys.maxsize,
        sort_keys=False,
        default_flow_style=True if layout.flow else False,  # noqa: SIM210 - PyYAML's third value is None
    )
    # PyYAML ends a document that is one plain value with a line of dots.
    return text[: -len(_END)] if text.endswith(f"\n{_END}") else text


def to_plain(value: Any, layout: Layout = WHOLE, field_type: str = "") -> Any:
    """The message as mappings, lists and scalars."""
    if hasattr(value, "get_fields_and_field_types"):
        types = value.get_fields_and_field_types()
        return {name: to_plain(getattr(value, name), layout, types[name]) for name in types}
    if isinstance(value, (bytes, str)):
        return _text(value if isinstance(value, str) else value.decode("latin-1"), layout)
    if isinstance(value, (list, tuple, array.array)) or hasattr(value, "tolist"):
        return _elements(value, layout, field_type)
    return value


def _text(value: str, layout: Layout) -> str:
    if not layout.strings:
        return f"<string length: <{len(value)}>>"
    if layout.truncate is not None and len(value) > layout.truncate:
        return f"{value[: layout.truncate]}..."
    return value


def _elements(value: Any, layout: Layout, field_type: str) -> Any:
    listed = value.tolist() if hasattr(value, "tolist") else list(value)
    if not isinstance(listed, list):  # a numpy scalar
        return listed
    if not layout.arrays and field_type:
        if field_type.startswith("sequence<"):
            return f"<sequence type: {field_type[9:-1]}, length: {len(listed)}>"
        return f"<array type: {field_type}>"
    elements = [to_plain(element, layout) for element in listed[: layout.truncate]]
    return [*elements, "..."] if len(elements) < len(listed) else elements


def to_csv(value: object, layout: Layout) -> str:
    """The scalars of a message in order, separated by commas."""
    plain = to_plain(value, layout)
    parts: list[str] = []

    def collect(part: object) -> None:
        if isinstance(part, dict):
            for inner in part.values():
                collect(inner)
        elif isinstance(part, list):
            for inner in part:
                collect(inner)
        else:
            parts.append(str(part))

    collect(plain)
    return ",".join(parts)


def add_layout(verb: ArgumentParser) -> None:
    """The options of every verb that shows messages."""
    verb.add_argument("-f", "--full-length", action="store_true", help="long strings and arrays in full")
    verb.add_argument("-l", "--truncate-length", type=int, default=TRUNCATE, metavar="N", help="where they are cut")
    verb.add_argument("--no-arr", action="store_true", help="no elements of arrays")
    verb.add_argument("--no-str", action="store_true", help="no strings")
    verb.add_argument("--flow-style", action="store_true", help="in one line")
    verb.add_argument("--csv", action="store_true", help="values separated by commas")


def layout_of(options: Namespace) -> Layout:
    """How much those options ask for."""
    return Layout(
        truncate=None if options.full_length else options.truncate_length,
        arrays=not options.no_arr,
        strings=not options.no_str,
        flow=options.flow_style,
    )

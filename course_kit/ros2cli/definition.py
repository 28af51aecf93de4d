"""The text of an interface as `ros2 interface show` prints it: messages inside it are written out below their field."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from course_kit.interfaces.comments import split_comment
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.errors import CommandError

if TYPE_CHECKING:
    from collections.abc import Iterator

_INTEGERS = {f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)}
_PRIMITIVES = _INTEGERS | {"bool", "byte", "char", "float32", "float64", "string", "wstring"}
_FIELD = re.compile(r"\s*(?P<type>[A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+[A-Za-z]\w*")


def known(name: str) -> Any:
    """The class of any interface, msg, srv or action."""
    from course_kit import interfaces

    try:
        return interfaces.get_type(name)
    except LookupError as problem:
        raise unknown(name) from problem
    except ValueError as problem:
        raise CommandError(str(problem)) from problem


def unknown(name: str) -> CommandError:
    """What to say about an interface that does not exist."""
    from course_kit import interfaces

    package = name.partition("/")[0]
    names = interfaces.types(package if package in interfaces.packages() else None)
    return CommandError(f"Unknown interface '{name}'.{did_you_mean(name, names)}")


def shown_lines(name: str, *, comments: bool, inner_comments: bool) -> Iterator[str]:
    """The lines of an interface's text."""
    from course_kit import interfaces

    try:
        text = interfaces.text_of(name)
    except LookupError as problem:
        raise unknown(name) from problem
    except ValueError as problem:
        raise CommandError(str(problem)) from problem
    yield from _lines(text.rstrip("\n"), name.partition("/")[0], comments, inner_comments, "")


def _lines(text: str, package: str, comments: bool, inner_comments: bool, indent: str) -> Iterator[str]:
    from course_kit import interfaces

    for written in text.splitlines():
        code, _ = split_comment(written)
        line = written.rstrip() if comments else code
        if line or comments:
            yield f"{indent}{line}" if line else ""
        inner = _inner_type(code, package)
        if inner:
            inner_text = interfaces.text_of(inner).rstrip("\n")
            yield from _lines(inner_text, inner.partition("/")[0], inner_comments, inner_comments, f"{indent}\t")


def _inner_type(code: str, package: str) -> str | None:
    """The message a field is of, None for anything else."""
    field = _FIELD.match(code)
    if field is None or field["type"] in _PRIMITIVES:
        return None
    parts = field["type"].split("/")
    return f"{parts[0] if len(parts) > 1 else package}/msg/{parts[-1]}"

"""What an interface's text says beside its fields: units and limits, which no class keeps."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from course_kit.interfaces import known_types

if TYPE_CHECKING:
    from course_kit.interfaces.message_fields import Message

_PARTS = {"srv": ("Request", "Response"), "action": ("Goal", "Result", "Feedback")}
_SEPARATOR = "---"
# A # inside quotes belongs to a default value.
_CODE = re.compile(r"""(?:[^#"']|"[^"]*"|'[^']*'|["'](?=[^"']*$))*""")
_FIELD = re.compile(r"\s*[A-Za-z][\w/]*(?:<=\d+)?(?:\[[^\]]*\])?\s+(?P<name>[a-z]\w*)")


def split_comment(line: str) -> tuple[str, str]:
    """A line of a definition as its code and its comment, without the # before it."""
    code = _CODE.match(line)
    end = code.end() if code else len(line)
    return line[:end].rstrip(), line[end:].lstrip("#").strip()


def comments_of(message_type: type[Message]) -> dict[str, str]:
    """The comments that stand in the lines of a message's fields, by the field; empty where its text is not known."""
    package, kind = [*message_type.__module__.split("."), ""][:2]
    name, _, part = message_type.__name__.rpartition("_")
    parts = _PARTS.get(kind, ())
    if parts and part not in parts:
        return {}
    whole = f"{package}/{kind}/{name if parts else message_type.__name__}"
    try:
        text = known_types.text_of(whole)
    except (LookupError, ValueError):
        return {}
    sections = re.split(rf"^{_SEPARATOR}.*$", text, flags=re.MULTILINE)
    section = sections[parts.index(part)] if parts else text
    found = {}
    for line in section.splitlines():
        code, comment = split_comment(line)
        field = _FIELD.match(code)
        if field and comment:
            found[field["name"]] = comment
    return found

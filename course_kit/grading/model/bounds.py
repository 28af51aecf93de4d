"""How much is kept of what a submission sends and says: enough for a person to read, whatever comes.

A message of 8 MB would otherwise stand in every check, in every report and on every page of a class.
"""

from __future__ import annotations

import json
from array import array
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.model.plain_data import Record

LONGEST_TEXT = 4096  # characters of a text in a message
MOST_ELEMENTS = 1000  # of a sequence in a message
_TEXTS = ("sent", "expected", "got", "message")  # of a check's result
_LONGEST = 3000  # bytes of each of them, as JSON
_TOGETHER = 160_000  # bytes of those of all checks
_MOST_STEPS, _LONGEST_STEP = 12, 400  # of an exchange
_MOST_IN_GRAPH = 100  # nodes, and things that they do
_PER_CHARACTER = 6  # bytes at most, as JSON
_DOTS = "..."


def bound_message(message: Any) -> Any:
    """A message, or what a field holds, in which no text and no sequence is too long; it is changed, not copied."""
    if isinstance(message, str):
        return message[:LONGEST_TEXT]
    if isinstance(message, (list, array)):
        last = message[-MOST_ELEMENTS:] if len(message) > MOST_ELEMENTS else message
        return list(map(bound_message, last)) if isinstance(last, list) else last
    for name in getattr(message, "get_fields_and_field_types", dict)():
        value = getattr(message, name)
        if (bounded := bound_message(value)) is not value:
            setattr(message, name, bounded)
    return message


def cut_text(text: str, longest: int = _LONGEST) -> str:
    """A text that takes at most so many bytes as JSON, and that UTF-8 can hold; of a longer one the beginning."""
    whole = text[:longest].encode("utf-8", errors="replace").decode("utf-8")
    if len(text) == len(whole) and _size(whole) <= longest:
        return whole
    room = longest - len(_DOTS)
    return (whole[:room] if _size(whole[:room]) <= room else whole[: room // _PER_CHARACTER]) + _DOTS


def bound_results(found: Sequence[Record]) -> list[Record]:
    """Results of checks as plain data, in which no text is too long, nor all of them together."""
    longest = min(_LONGEST, _TOGETHER // (len(_TEXTS) * max(len(found), 1)))
    bounded = []
    for each in found:
        texts = {name: cut_text(str(each[name]), longest) for name in _TEXTS}
        steps = [{**step, "text": cut_text(str(step["text"]), _LONGEST_STEP)} for step in each["steps"][:_MOST_STEPS]]
        graph = [part[:_MOST_IN_GRAPH] for part in each.get("graph") or ()] or None
        bounded.append({**each, **texts, "steps": steps, "graph": graph})
    return bounded


def _size(text: str) -> int:
    return len(json.dumps(text, ensure_ascii=False).encode()) - 2

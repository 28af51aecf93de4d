"""Text of strangers on its way into CSV and JSON: it arrives, and it steers nothing."""

from __future__ import annotations

import csv
import io
import json
import re
from typing import TYPE_CHECKING, Any

from course_kit.text.sanitize import printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

_DIGITS = 6
# What spreadsheets take for a formula, the wide forms of East Asian keyboards included, after any blank or invisible
# character; and a tab, carriage return or line end, which some of them drop before they look.
_FORMULA = re.compile(r"[\s\x00-\x1f\u00a0\u200b-\u200f\u2060\ufeff]*[=+\-@＝＋－＠]|[\t\r\n]")  # noqa: RUF001
_NUMBER = re.compile(r"-?\d{1,15}(\.\d+)?")
# What is read as text, a name or a number at worst, whatever sign it begins with: no call, no link, no other program.
_HARMLESS = re.compile(r"[\w.@+-]*", re.ASCII)


def number(value: float) -> str:
    """A number as people and machines read it: `8`, `7.5`, never `8.0` or `1e+06`."""
    rounded = round(value, _DIGITS)
    return str(int(rounded)) if rounded == int(rounded) else f"{rounded:.{_DIGITS}f}".rstrip("0")


class Identifier(str):
    """A cell by which a platform finds a student: with an apostrophe in front it would find nobody."""

    __slots__ = ()


def cell(value: str | float | None) -> str:
    """A cell of a CSV file that no spreadsheet takes for a formula."""
    if value is None:
        return ""
    if not isinstance(value, str):
        return number(value)
    if isinstance(value, Identifier) and _HARMLESS.fullmatch(value):
        return value
    text = printable(value)
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def csv_text(rows: Iterable[Sequence[str | float | None]], *, mark: bool = False) -> str:
    r"""Rows as CSV after RFC 4180: commas, quotes where they are needed, \r\n."""
    file = io.StringIO(newline="")
    csv.writer(file).writerows([cell(value) for value in row] for row in rows)
    return ("\ufeff" if mark else "") + file.getvalue()


def json_text(value: Any) -> str:
    """A JSON document of which each text is printable."""
    return json.dumps(_printable(value), indent=1, ensure_ascii=False)


def _printable(value: Any) -> Any:
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, dict):
        return {key: _printable(one) for key, one in value.items()}
    return [_printable(one) for one in value] if isinstance(value, (list, tuple)) else value

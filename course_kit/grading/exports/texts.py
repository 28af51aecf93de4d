"""Text of strangers on its way into CSV, XML and HTML: it arrives, and it steers nothing."""

from __future__ import annotations

import csv
import io
import re
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

_DIGITS = 6
# What spreadsheets take for a formula, the wide forms of East Asian keyboards included, after any blank or invisible
# character; and a tab, carriage return or line end, which some of them drop before they look.
_FORMULA = re.compile(r"[\s\x00-\x1f\u00a0\u200b-\u200f\u2060\ufeff]*[=+\-@＝＋－＠]|[\t\r\n]")  # noqa: RUF001
_NUMBER = re.compile(r"-?\d{1,15}(\.\d+)?")
# XML 1.0 has no way to write these, not even as a reference.
_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
# Control characters, and the marks that turn the writing round for whatever follows them.
_STEERING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]")
_REPLACEMENT = "\ufffd"


def number(value: float) -> str:
    """A number as people and machines read it: `8`, `7.5`, never `8.0` or `1e+06`."""
    rounded = round(value, _DIGITS)
    return str(int(rounded)) if rounded == int(rounded) else f"{rounded:.{_DIGITS}f}".rstrip("0")


def cell(value: str | float | None) -> str:
    """A cell of a CSV file that no spreadsheet takes for a formula.

    Numbers stay numbers, nothing is an empty cell; text that could be read as a formula gets an apostrophe in front,
    which spreadsheets take as "this is text".
    """
    if value is None:
        return ""
    if not isinstance(value, str):
        return number(value)
    text = whole(value)
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def csv_text(rows: Iterable[Sequence[str | float | None]], *, mark: bool = False) -> str:
    r"""Rows as CSV after RFC 4180: commas, quotes where they are needed, \r\n.

    Args:
        rows: the header and the rest.
        mark: begin with a byte order mark, without which Excel takes UTF-8 for something else.
    """
    file = io.StringIO(newline="")
    csv.writer(file).writerows([cell(value) for value in row] for row in rows)
    return ("\ufeff" if mark else "") + file.getvalue()


def whole(text: str) -> str:
    """Text that can be written as UTF-8: halves of characters, from file names of other encodings, are replaced."""
    return text.encode("utf-8", errors="replace").decode("utf-8")


def xml(text: str) -> str:
    """Text within XML elements and attributes; line ends and tabs survive in both."""
    legal = escape(_NOT_XML.sub(_REPLACEMENT, text))
    return legal.replace("\r", "&#13;").replace("\n", "&#10;").replace("\t", "&#9;")


def html(text: str) -> str:
    """Text within HTML elements and attributes; joined emoji and the joiners of Persian and Hindi stay whole."""
    return escape(_STEERING.sub(_REPLACEMENT, text))

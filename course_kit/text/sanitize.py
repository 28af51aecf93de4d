"""Text of strangers on its way to a terminal, a file or a page: it arrives, and it steers nothing."""

from __future__ import annotations

import re
import unicodedata
from html import escape

_JOINERS = "\u200c\u200d"  # zero width non-joiner and joiner
_BLANK = "Zs"  # Unicode's category: a wide blank between Japanese names, a narrow one before a unit
_HALVES = re.compile("[\ud800-\udfff]")
_LONGEST_NAME = 200  # characters
_FILLERS = dict.fromkeys(map(ord, "\u115f\u1160\u2800\u3164\uffa0"), " ")  # letters by their category that show nothing


def make_printable(text: str) -> str:
    """Text that steers nothing: no control characters but line ends and tabs, no marks that turn the writing round.

    The two joiners stay where writing needs them, within emoji and between letters of many scripts. The line ends of
    Windows become those of everybody else.
    """
    if text.isprintable():
        return text  # most are: that is much the faster way to see it
    text = text.replace("\r\n", "\n")
    return "".join(
        character if _is_harmless(character) or _joins(before, character) else "\ufffd"
        for before, character in zip(f" {text}", text, strict=False)
    )


def one_line(text: str) -> str:
    """A stranger's name as people read it, in one line; two names can become the same one here."""
    short = text if len(text) <= _LONGEST_NAME else f"{text[:_LONGEST_NAME]}\u2026"
    return make_printable(" ".join(unicodedata.normalize("NFC", short.translate(_FILLERS)).split()))


def escape_html(text: str) -> str:
    """Printable text within HTML, in elements and in attributes; templates do the same to whatever is filled in."""
    return escape(make_printable(text))


def make_encodable(document: str) -> str:
    """JSON that can be written as UTF-8: halves of characters, as of odd file names, become escapes."""
    return _HALVES.sub(lambda half: f"\\u{ord(half[0]):04x}", document)


def _is_harmless(character: str) -> bool:
    return character.isprintable() or character in "\n\t" or unicodedata.category(character) == _BLANK


def _joins(before: str, character: str) -> bool:
    """Whether this is a joiner that joins; between Latin letters it would only hide that two words differ."""
    return character in _JOINERS and before.isprintable() and not before.isascii()

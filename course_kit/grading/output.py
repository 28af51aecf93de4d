"""What a submission printed: all of it counted, its first and last 4 kB kept."""

from __future__ import annotations

import re
import unicodedata
from html import escape

_JOINERS = "\u200c\u200d"  # zero width non-joiner and joiner
_BLANK = "Zs"  # Unicode's category: a wide blank between Japanese names, a narrow one before a unit
_HALVES = re.compile("[\ud800-\udfff]")
KEPT = 4096  # bytes, at the beginning and at the end
_LONGEST_NAME = 200  # characters
_FILLERS = dict.fromkeys(map(ord, "\u115f\u1160\u2800\u3164\uffa0"), " ")  # letters by their category that show nothing


class Output:
    """The bytes of one stream, in bounded memory however much comes."""

    def __init__(self) -> None:
        self.count = 0
        self._head = bytearray()
        self._tail = bytearray()

    def add(self, data: bytes) -> None:
        """Take in what has just come."""
        self.count += len(data)
        room = KEPT - len(self._head)
        if room > 0:
            self._head += data[:room]
            data = data[room:]
        if data:
            self._tail += data
            del self._tail[:-KEPT]

    def text(self) -> str:
        """What was kept, with a line that says how much was left out in the middle."""
        left_out = self.count - len(self._head) - len(self._tail)
        if left_out <= 0:
            return _decode(bytes(self._head + self._tail))
        return f"{_decode(bytes(self._head))}\n[... {left_out} bytes left out ...]\n{_decode(bytes(self._tail))}"


def printable(text: str) -> str:
    """Text that steers nothing: no control characters but line ends and tabs, no marks that turn the writing round.

    The two joiners stay where writing needs them, within emoji and between letters of many scripts.
    """
    return "".join(
        character if _is_harmless(character) or _joins(before, character) else "\ufffd"
        for before, character in zip(f" {text}", text, strict=False)
    )


def _is_harmless(character: str) -> bool:
    return character.isprintable() or character in "\n\t" or unicodedata.category(character) == _BLANK


def one_line(text: str) -> str:
    """A stranger's name as people read it: printable, composed letters, one line, single spaces, not endless.

    Two different names can become the same one here; whoever tells people apart by them has to see to that.
    """
    short = text if len(text) <= _LONGEST_NAME else f"{text[:_LONGEST_NAME]}\u2026"
    return printable(" ".join(unicodedata.normalize("NFC", short.translate(_FILLERS)).split()))


def _joins(before: str, character: str) -> bool:
    """Whether this is a joiner that joins; between Latin letters it would only hide that two words differ."""
    return character in _JOINERS and before.isprintable() and not before.isascii()


def escaped(text: str) -> str:
    """The same as text in HTML, within elements and within attributes."""
    return escape(printable(text))


def encodable(document: str) -> str:
    """JSON that can be written as UTF-8: halves of characters become escapes, which mean the same.

    They come from file names that are not UTF-8 and from a submission's own texts.
    """
    return _HALVES.sub(lambda half: f"\\u{ord(half[0]):04x}", document)


def _decode(data: bytes) -> str:
    return printable(data.decode("utf-8", errors="replace").replace("\r\n", "\n"))

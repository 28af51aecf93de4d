"""A program's fingerprints: hashes of short runs of its tokens, in which names, values and layout play no part.

Renaming, comments, blank lines and moved functions change few of them. Of each window of neighbouring runs one is kept
(winnowing), so that any common run of `RUN + WINDOW - 1` tokens is found in both programs.
"""

from __future__ import annotations

import hashlib
import keyword
import re
import zlib
from functools import lru_cache

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

RUN = 14  # tokens: a line or two
WINDOW = 8
_MOST_TOKENS = 50_000
_IDENTITY = 32  # hexadecimal digits
_BASE = 1_000_003
_DROPPED = pow(_BASE, RUN, 1 << 64)  # the weight of the token that leaves a run
_64_BITS = (1 << 64) - 1
# A text that is not closed ends with its line, or with the program: so every quote begins something, and no part of the
# program is looked at again and again.
_TOKEN = re.compile(
    r"""
    (?P<skipped> \#[^\n]* | ^[ \t]*[rbuRBU]{0,2}(?:\"{3}.*?(?:\"{3}|\Z)|'{3}.*?(?:'{3}|\Z)) )  # comments and docstrings
  | (?P<string>  [a-zA-Z]{0,2}(?:\"{3}.*?(?:\"{3}|\Z)|'{3}.*?(?:'{3}|\Z)
                 |"[^"\\\n]*(?:\\.[^"\\\n]*)*"?|'[^'\\\n]*(?:\\.[^'\\\n]*)*'?) )
  | (?P<number>  \d[\w.]* )
  | (?P<name>    \w+ )
  | (?P<sign>    [^\w\s] )
    """,
    re.VERBOSE | re.MULTILINE | re.DOTALL,
)


def take_fingerprints(source: str) -> frozenset[int]:
    """The fingerprints of a Python text, which need not be correct."""
    runs = list(_runs([_number_of(token) for token in _tokens(source)]))
    windows = range(max(len(runs) - WINDOW + 1, min(len(runs), 1)))
    return frozenset(min(runs[place : place + WINDOW]) for place in windows)


def line_shape(line: str) -> tuple[str, ...]:
    """A line of a program without its names, values and layout; empty for one that is blank or a comment."""
    return tuple(_tokens(line))


def program_identity(source: str) -> str:
    """A hash of a program, equal for programs that differ in comments, docstrings, blanks and line ends alone."""
    tokens = (match.group() for match in _TOKEN.finditer(source) if match.lastgroup != "skipped")
    return hashlib.sha256("\n".join(tokens).encode("utf-8", errors="replace")).hexdigest()[:_IDENTITY]


def _runs(tokens: list[int]) -> Iterator[int]:
    """A hash of each run of neighbouring tokens, made of that of the run before."""
    value = 0
    for place, token in enumerate(tokens):
        value = value * _BASE + token
        if place >= RUN:
            value -= tokens[place - RUN] * _DROPPED
        value &= _64_BITS
        if place >= RUN - 1:
            mixed = ((value ^ value >> 29) * 0xBF58476D1CE4E5B9) & _64_BITS  # else many would begin alike
            yield mixed ^ mixed >> 32


def _tokens(source: str) -> list[str]:
    """Keywords and signs as they are, `v` for a name, `0` for a number, `s` for a text."""
    tokens = []
    for match in _TOKEN.finditer(source):
        kind, token = match.lastgroup, match.group()
        if kind == "name":
            tokens.append(token if keyword.iskeyword(token) else "v")
        elif kind == "sign":
            tokens.append(token)
        elif kind != "skipped":
            tokens.append("0" if kind == "number" else "s")
        if len(tokens) == _MOST_TOKENS:
            break
    return tokens


@lru_cache(maxsize=1024)
def _number_of(token: str) -> int:
    return zlib.crc32(token.encode("utf-8", errors="replace"))

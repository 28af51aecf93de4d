"""A program's fingerprints: hashes of short runs of its tokens, in which names, values and layout play no part.

Renaming, comments, blank lines and moved functions change few of them.
"""

from __future__ import annotations

import hashlib
import keyword
import re
import zlib

RUN = 14  # tokens: a line or two
ONE_IN = 4  # runs is kept, the same ones in each program
_MOST_TOKENS = 50_000
_IDENTITY = 32  # hexadecimal digits
_SHAPES: dict[str | None, str] = {"name": "v", "number": "0", "string": "s"}
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
    tokens = token_shapes(source)
    runs = ("\0".join(tokens[place : place + RUN]) for place in range(len(tokens) - RUN + 1))
    hashes = (zlib.crc32(run.encode("utf-8", errors="replace")) for run in runs)
    return frozenset(digest for digest in hashes if digest % ONE_IN == 0)


def program_identity(source: str) -> str:
    """A hash of a program, equal for programs that differ in comments, docstrings, blanks and line ends alone."""
    words = "\n".join(token for _, token in _read_tokens(source))
    return hashlib.sha256(words.encode("utf-8", errors="replace")).hexdigest()[:_IDENTITY]


def token_shapes(source: str) -> tuple[str, ...]:
    """Keywords and signs as they are, `v` for a name, `0` for a number, `s` for a text; comments do not count."""
    tokens = _read_tokens(source)[:_MOST_TOKENS]
    return tuple(token if keyword.iskeyword(token) else _SHAPES.get(kind, token) for kind, token in tokens)


def _read_tokens(source: str) -> list[tuple[str | None, str]]:
    return [(each.lastgroup, each.group()) for each in _TOKEN.finditer(source) if each.lastgroup != "skipped"]

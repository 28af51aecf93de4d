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
    tokens = _tokens(source)
    runs = ("\0".join(tokens[place : place + RUN]) for place in range(len(tokens) - RUN + 1))
    hashes = (zlib.crc32(run.encode("utf-8", errors="replace")) for run in runs)
    return frozenset(digest for digest in hashes if digest % ONE_IN == 0)


def line_shape(line: str) -> tuple[str, ...]:
    """A line of a program without its names, values and layout; empty for one that is blank or a comment."""
    return tuple(_tokens(line))


def program_identity(source: str) -> str:
    """A hash of a program, equal for programs that differ in comments, docstrings, blanks and line ends alone."""
    tokens = (match.group() for match in _TOKEN.finditer(source) if match.lastgroup != "skipped")
    return hashlib.sha256("\n".join(tokens).encode("utf-8", errors="replace")).hexdigest()[:_IDENTITY]


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

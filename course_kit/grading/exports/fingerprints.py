"""A program's fingerprints: hashes of short runs of its tokens, in which names, values and layout play no part.

Renaming, comments, blank lines and moved functions change few of them. Of each window of neighbouring runs one is kept
(winnowing), so that any common run of `RUN + WINDOW - 1` tokens is found in both programs.
"""

from __future__ import annotations

import keyword
import re
import zlib
from functools import lru_cache

import numpy as np

RUN = 14  # tokens: a line or two
WINDOW = 8
_MOST_TOKENS = 50_000
_BASE = 1_000_003
_TOKEN = re.compile(
    r"""
    (?P<skipped> \#[^\n]* | ^[ \t]*[rbuRBU]{0,2}(?:\"{3}.*?\"{3}|'{3}.*?'{3}) )  # comments and docstrings
  | (?P<string>  [a-zA-Z]{0,2}(?:\"{3}.*?\"{3}|'{3}.*?'{3}|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*') )
  | (?P<number>  \d[\w.]* )
  | (?P<name>    \w+ )
  | (?P<sign>    [^\w\s] )
    """,
    re.VERBOSE | re.MULTILINE | re.DOTALL,
)


def fingerprints(source: str) -> frozenset[int]:
    """The fingerprints of a Python text, which need not be correct."""
    tokens = np.array([_number_of(text) for text in _tokens(source)], dtype=np.uint64)
    if len(tokens) < RUN:
        return frozenset()
    runs = np.zeros(len(tokens) - RUN + 1, dtype=np.uint64)
    for place in range(RUN):  # arithmetic of uint64 goes round, as a hash may
        runs *= np.uint64(_BASE)
        runs += tokens[place : place + len(runs)]
    runs ^= runs >> np.uint64(29)
    runs *= np.uint64(0xBF58476D1CE4E5B9)  # else the smallest of a window would mostly begin alike
    runs ^= runs >> np.uint64(32)
    if len(runs) <= WINDOW:
        return frozenset({int(runs.min())})
    windows = np.lib.stride_tricks.sliding_window_view(runs, WINDOW)
    return frozenset(np.unique(windows.min(axis=1)).tolist())


def _tokens(source: str) -> list[str]:
    """Keywords and signs as they are, `v` for a name, `0` for a number, `s` for a text."""
    tokens = []
    for match in _TOKEN.finditer(source):
        kind, text = match.lastgroup, match.group()
        if kind == "name":
            tokens.append(text if keyword.iskeyword(text) else "v")
        elif kind == "sign":
            tokens.append(text)
        elif kind != "skipped":
            tokens.append("0" if kind == "number" else "s")
        if len(tokens) == _MOST_TOKENS:
            break
    return tokens


@lru_cache(maxsize=1024)
def _number_of(token: str) -> int:
    return zlib.crc32(token.encode("utf-8", errors="replace"))

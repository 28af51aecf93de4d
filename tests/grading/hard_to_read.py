"""Files that are hard to read: each makes Python compute, fill memory, or fail in a way of its own."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tests.grading.conftest import EXERCISE

if TYPE_CHECKING:
    from collections.abc import Callable

MB = 1 << 20
MAGIC = f"%%submission {EXERCISE}\n"
SYNTAX, NOTHING = "start.syntax", "start.nothing"


@dataclass(frozen=True)
class Hard:
    """One of them.

    Attributes:
        name: of the file.
        make: its text or its bytes, for a right solution.
        status: of the report, or two.
        said: a part of why there is no grade, or the diagnosis.
        score: the points.
    """

    name: str
    make: Callable[[str], str | bytes]
    status: tuple[str, ...]
    said: str
    score: float = 0.0

    def data(self, solution: str) -> bytes:
        made = self.make(solution)
        return made if isinstance(made, bytes) else made.encode()


def program(text: str, status: str = "crashed", said: str = SYNTAX) -> Hard:
    return Hard("answer.py", lambda _: text, (status,), said)


def notebook(make: Callable[[str], str], status: str, said: str, score: float = 0.0) -> Hard:
    return Hard("answer.ipynb", make, (status,), said, score)


def full(text: str, end: str = "") -> str:
    """A program of 1 MB."""
    return text * ((MB - len(end)) // len(text)) + end


def cells(*sources: str, more: str = "") -> str:
    """A notebook's JSON; `more` is put in as it is."""
    return json.dumps({"cells": [{"cell_type": "code", "source": one} for one in sources]})[:-1] + f"{more}}}"


def nested(opening: str, closing: str = "") -> str:
    return f"x = {opening * 90_000}1{closing * 90_000}\n"


# Before Python 3.12 its parser takes minutes for this one; since then seconds, about as many as it may.
_MANY_FIELDS = f'a = 1\nb = f"{"{a}" * 349_000}"\n'
_TOO_LONG = "more than 5 s of computing"
_NEW_PARSER = sys.version_info >= (3, 12)

PROGRAMS = {
    "blank lines": program(full("\n", "while"), said=SYNTAX),
    "a right program behind blank lines": Hard("answer.py", lambda right: full("\n", right), ("graded",), "", 10.0),
    "nothing but blank lines": program("\n" * MB, "unreadable", "is empty"),
    "an f-string of many fields": (
        Hard("answer.py", lambda _: _MANY_FIELDS, ("unreadable", "crashed"), "")
        if _NEW_PARSER
        else program(_MANY_FIELDS, "unreadable", _TOO_LONG)
    ),
    "parentheses in each other": program(nested("(", ")")),
    "minus before minus": program(nested("-")),
    "lambdas in each other": program(nested("lambda: ")),
    "f-strings in each other": program(
        "x = " + 'f"{' * 60 + "1" + '}"' * 60 + "\n", said=NOTHING if _NEW_PARSER else SYNTAX
    ),
    "a sum of half a million": program(
        full("1+", "1\n"), *(("unreadable", "crashes") if sys.version_info < (3, 11) else ())
    ),
    "more statements than memory": program(full("a;"), "unreadable", "more than 768 MB of memory"),
    "a number of a million digits": program(f"x = {'1' * (MB - 10)}\n"),
    "a line of 1 MB that is no Python": program(f"x = '{'a' * (MB - 10)}\n"),
    "null bytes": program("x = 1\n\0", "unreadable", "null bytes"),
    "one byte too many": program("#" * (MB + 1), "unreadable", "larger than 1024 kB"),
    "not UTF-8": Hard("answer.py", lambda _: b"x = '\xff'\n", ("unreadable",), "not UTF-8"),
    "a name with a line end": Hard(
        "ans\nwer.py", lambda _: "import nothing_of_this_name\n", ("crashed",), "start.import"
    ),
}
NOTEBOOKS = {
    "outputs of 60 MB": notebook(
        lambda right: cells(MAGIC + right, more=f', "x": "{"a" * (60 * MB)}"'), "graded", "", 10.0
    ),
    "more than 64 MB": notebook(
        lambda right: cells(MAGIC + right) + " " * (64 * MB), "unreadable", "larger than 64 MB"
    ),
    "lists in each other": notebook(
        lambda _: '{"cells": ' + "[" * 100_000 + "]" * 100_000 + "}", "unreadable", "not a Jupyter"
    ),
    "numbers of a million digits": notebook(
        lambda right: cells(MAGIC + right, more=f', "x": [{"1" * 1_000_000}, 1.{"1" * 1_000_000}]'), "graded", "", 10.0
    ),
    "keys that come twice": notebook(lambda right: '{"cells": [], ' + cells(MAGIC + right)[1:], "graded", "", 10.0),
    "a million empty cells": notebook(
        lambda right: cells(MAGIC + right)[:-2] + ', {"cell_type": "raw"}' * 1_000_000 + "]}", "graded", "", 10.0
    ),
    # Each cell has a place in the answer, and JSON writes each of these characters in six: more than it may have.
    "more parts than an answer holds": notebook(
        lambda _: cells(f"{MAGIC}#{chr(1) * 700_000}", *[MAGIC] * 300_000), "unreadable", "too many parts"
    ),
    "cells that are a text": notebook(lambda _: '{"cells": "abc"}', "unreadable", "not a Jupyter"),
    "cells that are none": notebook(lambda _: '{"cells": [null, 1, []]}', "unreadable", "not a Jupyter"),
    "more objects than memory": notebook(
        lambda right: cells(MAGIC + right, more=f', "x": [{"{}," * (20 * MB)}0]'), "unreadable", "768 MB of memory"
    ),
    "half of a character": notebook(
        lambda _: cells(MAGIC + "x = '\ud800'"), "unreadable", "half of a character (U+D800)"
    ),
    "more than 1 MB of code": notebook(lambda _: cells(MAGIC + "#" * MB), "unreadable", "more than 1024 kB of code"),
    "a million lines": notebook(lambda _: cells(MAGIC + "\n" * (MB - 5) + "1/0"), "crashed", "start.crash"),
}
FILES = {**PROGRAMS, **NOTEBOOKS}

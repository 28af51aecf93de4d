"""A submission: the program that was read out of a .py or .ipynb file."""

from __future__ import annotations

import os
from collections.abc import Mapping  # noqa: TC003 - msgspec looks it up
from dataclasses import dataclass, field
from typing import NamedTuple

from course_kit.grading.model.plain_data import Record  # noqa: TC001 - as above

LAUNCH_FILE = ".launch.py"  # what the name of one ends in


class UnreadableError(ValueError):
    """A submission that cannot be read; the text says why and what to do."""


class SyntaxFault(NamedTuple):
    """Where Python stopped reading: the line's number, 0 for nowhere, its text, and what Python says about it."""

    line: int
    text: str
    problem: str


@dataclass(frozen=True)
class Facts:
    """What a program's text gives away; for a diagnosis, never for a point."""

    awaits: bool = False
    floor_divides: bool = False
    rounds: bool = False
    loops: bool = False
    waits: bool = False  # a call that may wait for long stands in it
    # First and last line of each function, and whether it makes an asynchronous call and looks at the future itself.
    functions: tuple[tuple[int, int, bool], ...] = ()
    future: int = 0  # the first line in which the program makes a Future itself

    def waits_for_a_future(self, line: int) -> bool:
        """Whether the function around `line` makes an asynchronous call and looks at its future itself."""
        around = [lines for lines in self.functions if lines[0] <= line <= lines[1]]
        return max(around)[2] if around else False


@dataclass(frozen=True)
class Submission:
    """The program to run, as Python text with plain line ends."""

    name: str = ""  # the file's, for reports
    program: str = ""  # the name it runs under, ends in .py
    source: str = ""
    # for each cell of a notebook its number, from 1, and how many lines it gave
    places: tuple[tuple[str, int], ...] = ()
    fault: SyntaxFault | None = None
    facts: Facts = Facts()
    literal: Record | None = None  # what it sets the exercise's variable to, where its text tells, see `reader.python`
    twice: str = ""  # a class that several cells define
    # by name, where the exercise asks for several files; `source` is all of them then, one below the other
    files: Mapping[str, Submission] = field(default_factory=dict)

    @property
    def problem(self) -> str:
        """Why it is no Python, in one sentence; empty when it is."""
        if self.fault is None:
            return ""
        line, text, problem = self.fault
        problem = problem if problem.endswith(("?", ".")) else f"{problem}."
        if not line:
            return f"{problem[:1].upper()}{problem[1:]}"
        return f"In {self.describe_line(line)}: {problem}" + f" The line reads `{text}`." * bool(text)

    @property
    def note(self) -> str:
        """What to say of a notebook with several answers."""
        return f"several cells define {self.twice}: the last one counts" if self.twice else ""

    def describe_line(self, line: int) -> str:
        """`line 12`, for notebooks `In[17], line 2`, or `cell 3, line 2` of one that was not run."""
        before = 0
        for cell, lines in self.places:
            if before < line <= before + lines:
                return f"{cell}, line {line - before + 1}"  # its first line, %%submission, is not in the program
            before += lines
        return f"line {line}"


def decode_name(name: str) -> str:
    """A file's name or path as text, whatever bytes it is of and whatever the locale made of them."""
    try:
        return os.fsencode(name).decode(errors="replace")
    except UnicodeEncodeError:  # typed by somebody whose locale has no such letters
        return name.encode(errors="replace").decode()

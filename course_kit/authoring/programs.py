"""Programs in a text: the text itself, fenced code, regions of code between prose, and the strings of a program."""

from __future__ import annotations

import ast
import re
import textwrap
import warnings
from typing import TYPE_CHECKING

from course_kit.authoring.passages import Passage, plain

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

_FENCE = re.compile(
    r"^(?P<indent>[^\S\n]*)(?P<fence>`{3,}|~{3,})[^\n]*\n(?P<code>.*?)^[^\S\n]*(?P=fence)", re.MULTILINE | re.DOTALL
)
_BEGINS = re.compile(r'(import |from \w|class \w|(async )?def \w|@\w|"""|\w+\s*(:[^=\n]+)?=\s*[{(\[]|\{)')
_PROMPT = re.compile(r"^[^\S\n]*(>>>|\.\.\.|In \[\d*\]:) ?", re.MULTILINE)
_MAGIC = re.compile(r"^[^\S\n]*[%!].*$", re.MULTILINE)
_DEEPEST = 3  # programs within strings of programs within strings ...
_MOST_TRIES = 200  # places in a text where a program may begin
_NO_PYTHON = (SyntaxError, ValueError, MemoryError, RecursionError)


def programs(passage: Passage, matters: Callable[[str], bool], depth: int = 0) -> Iterator[tuple[Passage, ast.Module]]:
    """The programs in a text that matter, each with its tree.

    Args:
        passage: the text.
        matters: whether a text could hold something to look for; what cannot is not read further.
        depth: how deep in strings of other programs it stands.
    """
    if not matters(passage.text):
        return
    fenced = list(_FENCE.finditer(passage.text))
    for match in fenced:
        begin = passage.text.count("\n", 0, match.start("code"))
        yield from programs(_part(passage, begin, match["code"]), matters, depth)
    text = passage.text if not fenced else _FENCE.sub("", passage.text)
    for found in _readable(_part(passage, 0, text)):
        tree = parsed(found.text)
        if tree is None or not matters(found.text):
            continue
        yield found, tree
        if depth < _DEEPEST:
            for inner in _strings(found, tree):
                yield from programs(inner, matters, depth + 1)


def parsed(text: str) -> ast.Module | None:
    """A program's tree; None when it is no Python."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of odd escapes in strings
            return ast.parse(text)
    except _NO_PYTHON:
        return None


def _part(passage: Passage, begin: int, text: str) -> Passage:
    """A part of a passage that begins so many lines after it."""
    if not passage.line:
        return Passage(passage.place, text)
    line = passage.line + begin
    return Passage(f"line {line}", text, line)


def _readable(passage: Passage) -> Iterator[Passage]:
    """The text where it is Python, else the regions in it that are."""
    for text in dict.fromkeys((passage.text, _MAGIC.sub("", _PROMPT.sub("", passage.text)))):
        whole = textwrap.dedent(text).strip("\n")
        if parsed(whole) is not None:
            yield Passage(passage.place, whole, passage.line)
            return
    lines = textwrap.dedent(text).split("\n")
    begin = tries = 0
    while begin < len(lines) and tries < _MOST_TRIES:
        if not _BEGINS.match(lines[begin].lstrip()):
            begin += 1
            continue
        tries += 1
        length = _readable_length(_block(lines[begin:]))
        if length:
            yield _part(passage, begin, textwrap.dedent("\n".join(lines[begin : begin + length])))
        begin += max(length, 1)


def _block(lines: list[str]) -> list[str]:
    """The lines from the first one on that are indented no less."""
    indent = len(lines[0]) - len(lines[0].lstrip())
    end = next((number for number, line in enumerate(lines) if line.strip() and line[:indent].strip()), len(lines))
    return lines[:end]


def _readable_length(lines: list[str]) -> int:
    """How many lines from the first one are Python, as far as Python itself can say where it stops."""
    length = len(lines)
    while length and (stops := _stops_at(textwrap.dedent("\n".join(lines[:length])))) is not None:
        length = min(stops - 1, length - 1)
    return max(length, 0)


def _stops_at(text: str) -> int | None:
    """The line at which Python stops reading, None if it reads all; 0 where it does not say."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of odd escapes in strings
            ast.parse(text)
    except SyntaxError as fault:
        return fault.lineno or 0
    except _NO_PYTHON:
        return 0
    return None


def _strings(passage: Passage, tree: ast.Module) -> Iterator[Passage]:
    """The texts of several lines among a program's strings, and lists of lines."""
    for node in ast.walk(tree):
        text = ""
        if isinstance(node, ast.JoinedStr):
            text = "".join(str(one.value) if isinstance(one, ast.Constant) else "None" for one in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, (str, bytes)):
            text = node.value if isinstance(node.value, str) else node.value.decode(errors="replace")
        elif isinstance(node, (ast.List, ast.Tuple)):
            lines = [one.value for one in node.elts if isinstance(one, ast.Constant) and isinstance(one.value, str)]
            text = "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)
        if "\n" in text.strip():
            yield _part(passage, node.lineno - 1, plain(text))  # type: ignore[attr-defined]  # all of these have one

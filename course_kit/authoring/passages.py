"""Texts that a program may stand in, out of any file: of a notebook its cells and outputs, of data every string."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import dataclass
from html import unescape
from typing import TYPE_CHECKING, Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_LOOKED_AT = 8192  # bytes in which a file that is no text has a zero
_PAIR = 2
_COLOURS = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
_TAG = re.compile(r"<[^<>]{1,400}>")
_MARK = re.compile(r"%%submission[^\S\n]+(?P<exercise>\w+)")
_NO_PROGRAM = re.compile(r"^[^\S\n]*[%!?].*$", re.MULTILINE)  # magics and shell commands


@dataclass(frozen=True)
class Passage:
    """A text and where it stands.

    Attributes:
        place: such as `line 12` or `cell 3, output`.
        text: the text.
        line: the line its first one is, where `place` tells of lines; 0 elsewhere.
    """

    place: str
    text: str
    line: int = 0


def passages(path: Path) -> Iterator[Passage]:
    """The texts of a file; none of one that is no text."""
    data = path.read_bytes()
    if b"\0" in data[:_LOOKED_AT]:
        return
    text = plain(data.decode("utf-8-sig", errors="replace"))
    ending = path.name.rpartition(".")[2]
    if ending in ("ipynb", "json"):
        yield from _of_json(text, notebook=ending == "ipynb")
    elif ending == "toml":
        yield Passage("line 1", text, 1)
        yield from _of_toml(text)
    else:
        yield Passage("line 1", text, 1)
        if ending in ("html", "htm", "svg", "xml"):
            yield Passage("line 1", without_tags(text), 1)


def plain(text: str) -> str:
    """A text with plain line ends and without a terminal's colours."""
    return _COLOURS.sub("", text.replace("\r\n", "\n").replace("\r", "\n"))


def without_tags(text: str) -> str:
    """What a page shows of HTML."""
    return unescape(_TAG.sub("", text))


def _of_json(text: str, *, notebook: bool) -> Iterator[Passage]:
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        yield Passage("line 1", text, 1)
        return
    cells = data.get("cells") if isinstance(data, dict) else None
    if not notebook or not isinstance(cells, list):
        yield from (Passage(_place_in(text, found), found) for found in strings(data))
        return
    yield from _of_cells([cell for cell in cells if isinstance(cell, dict)])
    yield from (Passage("metadata", found) for found in strings({**data, "cells": []}))


def _of_cells(cells: list[dict[str, Any]]) -> Iterator[Passage]:
    sources = []
    for number, cell in enumerate(cells, 1):
        source = _joined(cell.get("source", ""))
        if cell.get("cell_type") == "code":
            sources.append(source)
        yield Passage(f"cell {number}", _NO_PROGRAM.sub("", source))
        yield from (Passage(f"cell {number}, output", found) for found in strings(cell.get("outputs", [])))
        others = {name: value for name, value in cell.items() if name not in ("source", "outputs")}
        yield from (Passage(f"cell {number}, metadata", found) for found in strings(others))
    marks = [match["exercise"] if (match := _MARK.match(source)) else "" for source in sources]
    bare = [_NO_PROGRAM.sub("", source) for source in sources]
    for exercise in dict.fromkeys(filter(None, marks)):
        of_it = [source for source, mark in zip(bare, marks, strict=True) if mark == exercise]
        yield Passage(f"the cells marked %%submission {exercise}", "\n".join(of_it))
    yield Passage("all code cells", "\n".join(bare))


def _of_toml(text: str) -> Iterator[Passage]:
    try:
        data = tomllib.loads(text)
    except ValueError:
        return
    yield from (Passage(_place_in(text, found), found) for found in strings(data))


def strings(data: Any) -> Iterator[str]:
    """Every text in plain data: strings, lists of lines joined, and tables of pairs as Python writes a dictionary."""
    if isinstance(data, str):
        text = plain(data)
        yield text
        if "</" in text:
            yield without_tags(text)
    elif isinstance(data, list):
        if len(data) > 1 and all(isinstance(one, str) for one in data):
            yield _joined(data)
        else:
            for one in data:
                yield from strings(one)
    elif isinstance(data, dict):
        pairs = {name: tuple(value) for name, value in data.items() if isinstance(value, list) and len(value) == _PAIR}
        if pairs:
            yield repr(pairs)
        for value in data.values():
            yield from strings(value)


def _joined(source: Any) -> str:
    """A cell's text, which may stand in its file as a list of lines, with or without their ends."""
    if not isinstance(source, list):
        return plain(str(source))
    lines = [str(line) for line in source]
    return plain("".join(line if line.endswith("\n") else f"{line}\n" for line in lines))


def _place_in(text: str, found: str) -> str:
    """The line of a file in which a string of it begins, as well as it can be told."""
    first = next((line.strip() for line in found.splitlines() if line.strip()), "")
    begin = text.find(first) if first else -1
    if begin < 0:
        begin = text.find(json.dumps(first)[1:-1]) if first else -1
    return f"line {text.count(chr(10), 0, begin) + 1}" if begin >= 0 else "somewhere"

"""The lines on which the tables and keys of a TOML text stand, which its reader does not tell.

Only for texts that the reader has read: whatever is odd was refused there, so looking for brackets, quotes and the
ends of lines is enough here.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_HEADER = re.compile(r"\s*(?P<many>\[\[|\[)\s*(?P<name>[^\]]+?)\s*\]")
_KEY = re.compile(r"""\s*(?P<name>"[^"]*"|'[^']*'|[\w-]+)\s*(?:\.[^=]*)?=""")
# What is no bracket: a comment, or a string in one of its four forms.
# A string that is not closed goes on to the end, so that no part of the text is looked at again and again.
_OPAQUE = re.compile(
    r'#[^\n]*|"""(?:\\.|[^\\])*?(?:"{3,5}|\Z)|\'\'\'.*?(?:\'{3,5}|\Z)|"(?:\\.|[^"\\\n])*"?|\'[^\'\n]*\'?',
    re.DOTALL,
)
_SYNTAX = re.compile(r"[\[\]{}=]")
_WRITTEN = re.compile(r"[^\n]")


@dataclass
class _Table:
    line: int
    keys: dict[str, tuple[int, int]] = field(default_factory=dict)  # first and last line of each


class Lines:
    """Where things stand in one text."""

    def __init__(self, text: str) -> None:
        self._lines = text.split("\n")
        self._root = _Table(1)
        self._tables: dict[str, list[_Table]] = {}
        bare = _OPAQUE.sub(_blanked, text).split("\n")
        table, number = self._root, 0
        within: tuple[_Table, str] | None = (
            None  # the table, and its key that a header such as [checks.expect] is about
        )
        while number < len(bare):
            first, number = number, _end(bare, number)
            if header := _HEADER.match(bare[first]):
                outer, _, key_name = header["name"].partition(".")
                within = (
                    (self._tables[outer][-1], key_name.split(".")[0]) if key_name and outer in self._tables else None
                )
                table = _Table(first + 1)
                self._tables.setdefault(header["name"], []).append(table)
            if within is not None:
                keys, key_name = within[0].keys, within[1]
                keys[key_name] = (keys.get(key_name, (first + 1, 0))[0], number)
            elif key := _KEY.match(bare[first]):
                table.keys.setdefault(key["name"].strip("\"'"), (first + 1, number))

    def of_key(self, key: str) -> int:
        """The line of a key at the top; of the beginning when there is none."""
        return self._root.keys.get(key, (1, 1))[0]

    def of_table(self, name: str, number: int = 0) -> int:
        """The line of the header of `[[name]]`, the one of that number; of the key of that name when there is none."""
        found = self._tables.get(name, [])
        return found[number].line if number < len(found) else self.of_key(name)

    def within(self, name: str, number: int, key: str, *words: str) -> int:
        """The line of a key in `[[name]]`, or within its value the first line with some words, at least with the first.

        Args:
            name: of the table.
            number: which one of that name.
            key: the key; without it, the line of the table is returned.
            words: what to look for in the value.
        """
        found = self._tables.get(name, [])
        if number >= len(found):
            return self.of_key(name)
        first, last = found[number].keys.get(key, (found[number].line, found[number].line))
        for wanted in (words, words[:1]):
            for line in range(first, last + 1):
                if wanted and all(_has(self._lines[line - 1], word) for word in wanted):
                    return line
        return first


def _has(line: str, word: str) -> bool:
    return bool(word) and any(
        not _joins(line[at - 1 : at]) and not _joins(line[at + len(word) :][:1]) for at in _places(word, line)
    )


def _blanked(found: re.Match[str]) -> str:
    """Without what could be taken for structure; a quoted name on one line stays readable."""
    plain = "\n" not in found[0] and not found[0].startswith("#")
    return _SYNTAX.sub(" ", found[0]) if plain else _WRITTEN.sub(" ", found[0])


def _end(bare: list[str], first: int) -> int:
    """The number after the last line of what begins on a line: a value goes on while a bracket of it is open."""
    if _HEADER.match(bare[first]) or "=" not in bare[first]:
        return first + 1
    depth, number = 0, first
    while number < len(bare):
        depth += sum(bare[number].count(one) for one in "[{") - sum(bare[number].count(one) for one in "]}")
        number += 1
        if depth <= 0:
            break
    return number


def _places(word: str, line: str) -> Iterator[int]:
    at = line.find(word)
    while at >= 0:
        yield at
        at = line.find(word, at + 1)


def _joins(character: str) -> bool:
    return character.isalnum() or character == "_"

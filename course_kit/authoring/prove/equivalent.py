"""Mutants that an author has declared to be right programs, or as good as right, each with the reason.

They stand in a file `equivalent.toml`: beside the solution of one of the course's own exercises, in the folder `proof`
of another one's.

    [[equivalent]]
    line = 'self.status = self.create_publisher(String, "status", 10)'
    operators = ["another number"]
    reason = "The depth of a queue is free."

An entry is about all mutants of these operators on lines with this text. With `change` it is about the one that puts
this text in the line's place, and with `ordinal`, where several lines have the same text, about the first, second ... .
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.authoring.prove.mutants import Mutant

FILE = "equivalent.toml"
_FIELDS = {"line": str, "operators": list, "reason": str, "change": str, "ordinal": int}
_NEEDED = ("line", "operators", "reason")


@dataclass(frozen=True)
class DeclaredEquivalent:
    """One entry; `change` is empty and `ordinal` 0 where it leaves them open."""

    line: str
    operators: tuple[str, ...]
    reason: str
    change: str = ""
    ordinal: int = 0

    def covers(self, mutant: Mutant) -> bool:
        """Whether it is about a mutant."""
        return (
            mutant.operator in self.operators
            and mutant.before == self.line
            and self.change in ("", mutant.after)
            and self.ordinal in (0, mutant.ordinal)
        )

    def __str__(self) -> str:
        change = f" -> {self.change}" if self.change else ""
        return f"{' and '.join(self.operators)}: {self.line}{change}"


def read(path: Path) -> list[DeclaredEquivalent]:
    """The entries of a file; none when it is not there.

    Raises:
        GradingError: it cannot be used; the text says why.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return []
    except (OSError, ValueError) as problem:
        raise GradingError(f"{path} cannot be read: {problem}.") from problem
    try:
        table = tomllib.loads(text)
    except ValueError as problem:
        raise GradingError(f"{path} is not TOML: {problem}.") from problem
    if set(table) - {"equivalent"} or not isinstance(table.get("equivalent", []), list):
        raise GradingError(f"{path} has to hold [[equivalent]] and nothing else.")
    return [_entry(entry, path, number) for number, entry in enumerate(table.get("equivalent", []), start=1)]


def _entry(entry: object, path: Path, number: int) -> DeclaredEquivalent:
    where = f"{path}: entry {number} of [[equivalent]]"
    if not isinstance(entry, dict):
        raise GradingError(f"{where} is not a table.")
    for name in _NEEDED:
        if not entry.get(name):
            raise GradingError(f"{where} has no '{name}'.")
    for name, value in entry.items():
        if name not in _FIELDS:
            raise GradingError(f"{where} has a field '{name}'; there are {', '.join(_FIELDS)}.")
        if not isinstance(value, _FIELDS[name]):
            raise GradingError(f"{where}: '{name}' is not {'a text' if _FIELDS[name] is str else 'what it should be'}.")
    operators = tuple(str(one) for one in entry["operators"])
    return DeclaredEquivalent(**{**entry, "line": entry["line"].strip(), "operators": operators})

"""Mutants that an author has declared to be right programs, or as good as right, each with the reason.

They stand in a file `equivalent.toml`: beside the solution of one of the course's own exercises, in the folder `proof`
of another one's.

    [[equivalent]]
    lines = ['self.status = self.create_publisher(String, "status", 10)']
    operators = ["another number"]
    reason = "The depth of a queue is free."

An entry is about all mutants of these operators on lines with these texts; lines may move. With `change` it is about
those in whose change, `old -> new`, these words stand, and with `ordinal`, where several have the same, about the
first, second ... of them.
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
    from collections.abc import Iterator
    from pathlib import Path

    from course_kit.authoring.prove.mutants import Mutant
    from course_kit.grading.model.exercise import Exercise

FILE = "equivalent.toml"
_FIELDS = {"lines": list, "operators": list, "reason": str, "change": str, "ordinal": int}
_NEEDED = ("lines", "operators", "reason")


@dataclass(frozen=True)
class DeclaredEquivalent:
    """One operator on one line; `change` is empty and `ordinal` 0 where they are left open."""

    line: str
    operator: str
    change: str = ""
    ordinal: int = 0

    def covers(self, mutant: Mutant) -> bool:
        """Whether it is about a mutant."""
        return (
            mutant.operator == self.operator
            and mutant.before == self.line
            and self.change in mutant.change
            and self.ordinal in (0, mutant.ordinal)
        )

    def __str__(self) -> str:
        return f"{self.operator}: {self.line}{f': {self.change}' if self.change else ''}"


def file_of(exercise: Exercise) -> Path:
    """The declarations of an exercise, in its own proof set, or else beside its solution; the file need not exist."""
    own = exercise.solution.is_relative_to(exercise.folder)
    return (exercise.folder / "proof" if own else exercise.solution.parent) / FILE


def read(path: Path) -> list[DeclaredEquivalent]:
    """The entries of a file, one for each line and operator; none when it is not there."""
    try:
        entries = tomllib.loads(path.read_text(encoding="utf-8"))["equivalent"]
        return [one for number, entry in enumerate(entries, start=1) for one in _declared(entry, number)]
    except FileNotFoundError:
        return []
    except KeyError:
        raise GradingError(f"{path} cannot be used: it has no [[equivalent]].") from None
    except (OSError, ValueError, TypeError, AttributeError) as problem:
        raise GradingError(f"{path} cannot be used: {problem}.") from problem


def _declared(entry: dict[str, object], number: int) -> Iterator[DeclaredEquivalent]:
    where = f"entry {number} of [[equivalent]]"
    if missing := next((name for name in _NEEDED if not entry.get(name)), None):
        raise ValueError(f"{where} has no '{missing}'")
    for name, value in entry.items():
        if name not in _FIELDS:
            raise ValueError(f"{where} has a field '{name}'. There are: {', '.join(_FIELDS)}")
        if type(value) is not _FIELDS[name]:
            raise ValueError(f"{where}: '{name}' has to be a {_FIELDS[name].__name__}")
    for line in entry["lines"]:  # type: ignore[attr-defined]  # a list, as we have seen
        for operator in entry["operators"]:  # type: ignore[attr-defined]
            yield DeclaredEquivalent(line.strip(), operator, entry.get("change", ""), entry.get("ordinal", 0))  # type: ignore[arg-type]

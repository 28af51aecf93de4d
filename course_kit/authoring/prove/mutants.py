"""Every small mistake in a solution, each once; and those that an author has declared to be right (`equivalent.toml`).

AUTHORING.md has its form. With `ordinal` an entry is about the first, second ... of several alike.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec

from course_kit.authoring.prove import mistakes, ros_mistakes
from course_kit.authoring.prove.program import ParsedProgram, line_of
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.authoring.prove.program import New
    from course_kit.grading.model.exercise import Exercise

FILE = "equivalent.toml"


@dataclass(frozen=True)
class Mutant:
    """A solution with one mistake."""

    operator: str  # what kind of mistake
    line: int  # where, from 1
    before: str  # that line, without blanks around it
    change: str  # `old -> new`, as `ast` writes both
    ordinal: int  # which of those with the same three, from 1
    source: str  # the whole program
    file: str = ""  # its name, as the solution has it

    @property
    def key(self) -> str:
        """Its name, which stays the same when lines are added above it."""
        more = f" (no. {self.ordinal})" if self.ordinal > 1 else ""
        return f"{self.operator}: {self.before}: {self.change}{more}"


def make_mutants(source: str, *, starts_itself: bool = True, file: str = "") -> list[Mutant]:
    """All mutants of a program, in the order of its lines; without those that nobody can see."""
    program = ParsedProgram(source, starts_itself=starts_itself)
    lines = source.split("\n")
    seen = {"", ast.unparse(program.tree)}
    found: list[Mutant] = []
    counted: Counter[tuple[str, str, str]] = Counter()
    changes = [change for operator in (*ros_mistakes.MISTAKES, *mistakes.MISTAKES) for change in operator(program)]
    for change in sorted(changes, key=lambda change: line_of(change.at or change.node)):
        text = program.text_with(change)
        if text in seen:
            continue
        seen.add(text)
        line = line_of(change.at or change.node)
        mistake = change.operator, lines[line - 1].strip(), f"{_write_node(change.node)} -> {_write_node(change.new)}"
        counted[mistake] += 1
        found.append(Mutant(change.operator, line, *mistake[1:], counted[mistake], text, file))
    return found


def _write_node(node: ast.AST | New) -> str:
    """A node in one line."""
    if node is None:
        return "nothing"
    parts = node if isinstance(node, list) else [node]
    return " / ".join(line.strip() for part in parts for line in ast.unparse(part).split("\n"))


class _Entry(msgspec.Struct, forbid_unknown_fields=True):
    lines: list[str]
    operators: list[str]
    reason: str
    change: str = ""
    ordinal: int = 0


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
    if exercise.solution.is_relative_to(exercise.folder):
        return exercise.folder / "proof" / FILE
    return (exercise.solution if exercise.files else exercise.solution.parent) / FILE


def read_equivalents(path: Path) -> list[DeclaredEquivalent]:
    """The entries of a file, one for each line and operator; none when it is not there."""
    try:
        entries = msgspec.toml.decode(path.read_bytes(), type=dict[str, list[_Entry]])
    except FileNotFoundError:
        return []
    except (OSError, ValueError) as problem:
        mistake = re.sub(r"`\$\[\.\.\.\]\[(\d+)\]", lambda place: f"`entry {int(place[1]) + 1}", str(problem))
        raise GradingError(f"{path} cannot be used: {mistake}.") from problem
    return [
        DeclaredEquivalent(line.strip(), operator, entry.change, entry.ordinal)
        for entry in entries.get("equivalent", ())
        for line in entry.lines
        for operator in entry.operators
    ]

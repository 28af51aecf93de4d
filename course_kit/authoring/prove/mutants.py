"""Every small mistake in a solution, each once."""

from __future__ import annotations

import ast
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.authoring.prove import mistakes, ros_mistakes
from course_kit.authoring.prove.program import ParsedProgram, line_of

if TYPE_CHECKING:
    from course_kit.authoring.prove.program import New


@dataclass(frozen=True)
class Mutant:
    """A solution with one mistake."""

    operator: str  # what kind of mistake
    line: int  # where, from 1
    before: str  # that line, without blanks around it
    change: str  # `old -> new`, as `ast` writes both
    ordinal: int  # the how manieth with the same three, from 1
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
    changes = [one for operator in (*ros_mistakes.MISTAKES, *mistakes.MISTAKES) for one in operator(program)]
    for one in sorted(changes, key=lambda one: line_of(one.at or one.node)):
        text = program.text_with(one)
        if text in seen:
            continue
        seen.add(text)
        line = line_of(one.at or one.node)
        mistake = one.operator, lines[line - 1].strip(), f"{_written(one.node)} -> {_written(one.new)}"
        counted[mistake] += 1
        found.append(Mutant(one.operator, line, *mistake[1:], counted[mistake], text, file))
    return found


def _written(node: ast.AST | New) -> str:
    """A node in one line."""
    if node is None:
        return "nothing"
    parts = node if isinstance(node, list) else [node]
    return " / ".join(line.strip() for part in parts for line in ast.unparse(part).split("\n"))

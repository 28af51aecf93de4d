"""Every small mistake in a solution, each once."""

from __future__ import annotations

import difflib
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.authoring.prove.operators import endpoints, expressions, ros, statements
from course_kit.authoring.prove.program import ParsedProgram, parsed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from course_kit.authoring.prove.program import Mutation

OPERATORS: tuple[Callable[[ParsedProgram], Iterator[Mutation]], ...] = (
    endpoints.endpoint_names,
    endpoints.endpoint_types,
    endpoints.quality_of_service,
    endpoints.destroyed,
    ros.callbacks,
    ros.goal_status,
    ros.messages,
    ros.failing,
    ros.spinning,
    ros.parameters,
    ros.parameter_types,
    ros.groups,
    expressions.operators,
    expressions.comparisons,
    expressions.numbers,
    expressions.texts,
    expressions.elements,
    expressions.names,
    statements.conditions,
    statements.statements,
    statements.arguments,
)


@dataclass(frozen=True)
class Mutant:
    """A solution with one mistake."""

    operator: str  # what kind of mistake
    line: int  # where, from 1
    before: str  # that line, without blanks around it
    after: str  # what stands there instead, without blanks around it; further lines follow after ` / `
    ordinal: int  # the how manieth with the same four, from 1
    source: str  # the whole program
    diff: tuple[str, ...]  # what differs, line by line, the old ones with `-` and the new ones with `+`

    @property
    def key(self) -> str:
        """Its name, which stays the same when lines are added above it."""
        more = f" (no. {self.ordinal})" if self.ordinal > 1 else ""
        return f"{self.operator}: {self.before} -> {self.after}{more}"


def of(source: str, *, starts_itself: bool = True) -> list[Mutant]:
    """All mutants of a program, in the order of its lines; without those that nobody can see."""
    program = ParsedProgram(source, starts_itself=starts_itself)
    seen = {parsed(source)}
    found: list[Mutant] = []
    counted: Counter[tuple[str, str, str]] = Counter()
    changes = [change for operator in OPERATORS for change in operator(program)]
    for change in sorted(changes, key=lambda one: one.line):
        text = program.apply(change.edits)
        meaning = parsed(text)
        if not meaning or meaning in seen:
            continue
        seen.add(meaning)
        diff = _diff(program.source, text)
        before = program.lines[change.line - 1].strip()
        after = " / ".join(line[1:].strip() for line in diff if line.startswith("+"))
        counted[change.operator, before, after] += 1
        ordinal = counted[change.operator, before, after]
        found.append(Mutant(change.operator, change.line, before, after, ordinal, text, tuple(diff)))
    return found


def _diff(old: str, new: str) -> list[str]:
    lines = difflib.unified_diff(old.split("\n"), new.split("\n"), lineterm="", n=0)
    return [line for line in lines if line[:3] not in ("---", "+++") and line[:2] != "@@"]

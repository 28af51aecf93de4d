"""The steps of a lesson with their solutions in place: as nbval runs them, and as their outputs are stored.

A step is an empty cell, the cell `%check NAME` below it, and a fold below that with the solution.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from nbformat import NotebookNode

_CHECK = re.compile(r"%check (\w+)")
_SOLUTION = re.compile(r"<summary>One way to do it</summary>\s*```(?:python)?\n(.*?)\n```", re.DOTALL)


class StepCells(NamedTuple):
    """A step's place in its notebook."""

    name: str
    empty: NotebookNode
    check: NotebookNode
    fold: NotebookNode

    @property
    def solution(self) -> str:
        """The code of the fold."""
        found = _SOLUTION.search(self.fold.source)
        if found is None:
            raise ValueError(f"the cell below %check {self.name} has no fold with a solution")
        return found[1]


def steps_of(notebook: NotebookNode) -> list[StepCells]:
    """The steps of a notebook, from top to bottom."""
    cells = notebook.cells
    found = [(_CHECK.fullmatch(cell.source), place) for place, cell in enumerate(cells) if cell.cell_type == "code"]
    return [StepCells(match[1], *cells[place - 1 : place + 2]) for match, place in found if match]


def solve_steps(notebook: NotebookNode) -> list[StepCells]:
    """Put each solution into its empty cell, and have each check raise unless it passes; returns the steps."""
    found = steps_of(notebook)
    for step in found:
        step.empty.source = step.solution
        step.check.source = f"found = %check {step.name}\nassert found.passed, found"
    return found


def empty_steps(steps: list[StepCells], sources: list[str]) -> None:
    """Take the solutions out again, with all that was printed: a learner begins with an empty cell."""
    for step, source in zip(steps, sources, strict=True):
        step.empty.source, step.check.source = source, f"%check {step.name}"
        step.empty.outputs = step.check.outputs = []

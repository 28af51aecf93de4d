"""Notebooks on their way to students: without the cells that belong to the instructor."""

from __future__ import annotations

from typing import Any

ANSWER = "answer"  # a cell with this tag is the answer to a demo; it belongs to the instructor
INSTRUCTOR = "instructor"  # one with this tag speaks to whoever shows it


def has_answers(notebook: Any) -> bool:
    """Whether a notebook has cells of the instructor."""
    return any(_is_instructors(cell) for cell in notebook.cells)


def remove_answers(notebook: Any) -> Any:
    """A notebook without the cells of the instructor; the others are numbered anew."""
    notebook.cells = [cell for cell in notebook.cells if not _is_instructors(cell)]
    number_anew(notebook)
    return notebook


def number_anew(notebook: Any) -> None:
    """Number the cells that have been run from 1, as a fresh kernel would; the others stay without a number."""
    run = [cell for cell in notebook.cells if cell.cell_type == "code" and cell.execution_count is not None]
    for number, cell in enumerate(run, start=1):
        cell.execution_count = number
        for output in cell.outputs:
            if output.output_type == "execute_result":
                output.execution_count = number


def _is_instructors(cell: Any) -> bool:
    return not {ANSWER, INSTRUCTOR}.isdisjoint(cell.metadata.get("tags", []))

"""The `%%submission` cells of a notebook, as they were last run: which of them count, and what is said about them.

The kernel knows what was run, not what the notebook shows. JupyterLab tells it which cell is run and which were
deleted since the last one; and the notebook's file shows what was deleted or edited before it was last saved.
"""

from __future__ import annotations

import re
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_kit.environment.notebook import saved_cells

if TYPE_CHECKING:
    from collections.abc import Iterable

_CLASS = re.compile(r"^class\s+(\w+)", re.MULTILINE)
_MARK = re.compile(r"\s*%%submission\s+(\S+)(?:[^\S\n]+(\S+))?")


@dataclass
class SubmissionCell:
    """A cell that was run."""

    source: str
    number: int = 0
    run_s: float = field(default_factory=time.time)

    @property
    def file(self) -> str:
        """The file of the exercise that it holds, or a part of it; empty where the exercise is one program."""
        marked = _MARK.match(self.source)
        return (marked and marked[2]) or ""

    def __str__(self) -> str:
        place = f"In[{self.number}], run at {_describe_time(self.run_s)}" if self.number else "a cell that was not run"
        return f"{self.file} in {place}" if self.file else place


class SubmissionCells:
    """The `%%submission` cells of this session as last run, in the notebook's order."""

    def __init__(self) -> None:
        self._cells: dict[str, dict[str, SubmissionCell]] = {}
        self._gone: dict[str, float] = {}  # when a cell was deleted, or lost its mark
        self._unmarked: dict[str, int] = {}  # in which cell without the magic a class was last defined

    def keep(self, exercise: str, cell_id: str | None, source: str, number: int = 0) -> None:
        """Remember a cell's text; a cell without an id (no JupyterLab behind it) replaces all of its file."""
        cells, made = self._cells.setdefault(exercise, {}), SubmissionCell(source, number)
        if cell_id is None:
            cells = {key: cell for key, cell in cells.items() if cell.file != made.file}
        self._cells[exercise] = {**cells, cell_id or made.file: made}

    def forget_cells(self, cell_id: str | None, source: str, deleted: Iterable[str] = ()) -> None:
        """Any cell is about to run."""
        marked = _MARK.match(source)
        for exercise, cells in self._cells.items():
            deleted_cells = set(deleted)
            if cell_id is not None and not (marked and marked[1] == exercise):
                deleted_cells.add(cell_id)  # its mark was removed, or names another exercise
            self._cells[exercise] = {key: cell for key, cell in cells.items() if key not in deleted_cells}
            self._gone.update(dict.fromkeys(deleted_cells, time.time()))

    def note_unmarked(self, source: str, number: int) -> None:
        """Any cell was run."""
        if not _MARK.match(source):
            self._unmarked.update(dict.fromkeys(_CLASS.findall(source), number))

    def cells_of(self, exercise: str) -> list[SubmissionCell]:
        """The cells that make up the submission: those that were run and, as for a class, those that were saved."""
        saved, saved_s = saved_cells()
        order = {cell_id: place for place, cell_id in enumerate(saved)}
        cells = {
            cell_id: cell
            for cell_id, cell in self._cells.get(exercise, {}).items()
            if cell_id in saved or not saved or saved_s <= cell.run_s
        }
        if cells:
            not_run = {
                cell_id: SubmissionCell(source)
                for cell_id, source in saved.items()
                if (marked := _MARK.match(source)) and marked[1] == exercise
                if saved_s > self._gone.get(cell_id, 0.0)
            }
            cells = {**not_run, **cells}
        return [cells[cell_id] for cell_id in sorted(cells, key=lambda cell_id: order.get(cell_id, len(order)))]

    def warnings(self, exercise: str) -> list[str]:
        """What the notebook shows and is not graded, a sentence each."""
        graded = self.cells_of(exercise)
        saved, saved_s = saved_cells()
        notes = []
        if any(not cell.number for cell in graded):
            notes.append(
                f"A cell that begins with %%submission {exercise} was not run since the kernel started. It was graded, "
                "too, as it would be in a class. Delete it if it does not belong to your answer."
            )
        for cell_id, cell in self._cells.get(exercise, {}).items():
            now = saved.get(cell_id)
            if cell in graded and now is not None and saved_s > cell.run_s and now.strip() != cell.source.strip():
                notes.append(
                    f"In[{cell.number}] was edited after you ran it (saved at {_describe_time(saved_s)}). "
                    "Run it again to have the change graded."
                )
        last = max((cell.number for cell in graded), default=0)
        classes = {name for cell in graded for name in _CLASS.findall(cell.source)}
        notes += [
            f"In[{number}] defines {name} again, without %%submission {exercise} in its first line: it is not graded."
            for name, number in self._unmarked.items()
            if name in classes and number > last
        ]
        return notes


def _describe_time(seconds: float) -> str:
    return time.strftime("%H:%M:%S", time.localtime(seconds))

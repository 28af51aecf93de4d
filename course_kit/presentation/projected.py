"""The copy of a notebook that a class sees, made from the one file that also holds the speaker's notes.

Left out are notes (`slideshow.slide_type` "notes") and cells tagged `instructor`, `offstage` or `answer`. Where the
metadata of an answer says `course_kit.repairs` with the id of a failing cell, a button puts it in that cell's place.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from course_kit.authoring.edition_notebooks import ANSWER, INSTRUCTOR

OFFSTAGE = "offstage"  # a cell with this tag speaks to a reader, not to a class
OURS = "course_kit"  # the kit's own key in the metadata of a cell
REPAIRS, REPAIRED = "repairs", "repaired"
_PREAMBLE = ("%", "import ", "from ", "#")


@dataclass(frozen=True)
class SpokenCell:
    """What a speaker needs to know of a cell of the projected copy."""

    cell_id: str
    kind: str
    label: str
    notes: list[str]  # those below it; the first has those at the very top, too


def project_notebook(notebook: Any) -> Any:
    """A notebook as a class sees it first: no outputs, no notes, no remarks, and the failure before the repair."""
    repairs = {repairs_of(cell): cell.source for cell in notebook.cells if repairs_of(cell)}
    notebook.cells = [cell for cell in notebook.cells if _is_projected(cell)]
    for cell in notebook.cells:
        cell.metadata = {OURS: {REPAIRED: repairs[cell.id]}} if cell.id in repairs else {}
        if cell.cell_type == "code":
            cell.outputs = []
            cell.execution_count = None
    return notebook


def speaker_script(notebook: Any) -> list[SpokenCell]:
    """What the speaker's window shows of a notebook, cell by cell; the repair is last before what follows it."""
    spoken: list[SpokenCell] = []
    at_the_top: list[str] = []
    for cell in notebook.cells:
        kind = "repair" if repairs_of(cell) else cell.cell_type
        if _is_notes(cell):
            (spoken[-1].notes if spoken else at_the_top).append(cell.source)
        elif kind == "repair" or _is_projected(cell):
            spoken.append(SpokenCell(cell.id, kind, _label(kind, cell.source), [] if spoken else at_the_top))
    return spoken


def talk_minutes(notebook: Any) -> int:
    """How long it takes with talk, as its first cell says; 0 where it does not."""
    stated = notebook.cells[0].metadata.get(OURS, {}).get("minutes", 0) if notebook.cells else 0
    return stated if isinstance(stated, int) else 0


def repairs_of(cell: Any) -> str:
    """The id of the failing cell that this cell repairs; empty if none."""
    return str(cell.metadata.get(OURS, {}).get(REPAIRS, ""))


def notebook_title(notebook: Any) -> str:
    """The first heading."""
    first = notebook.cells[0].source if notebook.cells else ""
    return _label("markdown", first)


def _is_notes(cell: Any) -> bool:
    return bool(cell.metadata.get("slideshow", {}).get("slide_type") == "notes")


def _is_projected(cell: Any) -> bool:
    return not _is_notes(cell) and {ANSWER, INSTRUCTOR, OFFSTAGE}.isdisjoint(cell.metadata.get("tags", []))


def _label(kind: str, source: str) -> str:
    """The line that says most of a cell: a heading, or the first that neither imports nor loads anything."""
    lines = [line.strip() for line in source.splitlines() if line.strip()]
    if kind == "markdown":
        return lines[0].lstrip("# ").replace("*", "").replace("`", "") if lines else ""
    telling = [line for line in lines if not line.startswith(_PREAMBLE)]
    return (telling or lines or [""])[0]

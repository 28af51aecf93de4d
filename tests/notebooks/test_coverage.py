"""Every item of the syllabus has its place in a lesson, in a cell that runs.

Writes the table to artifacts/coverage.md.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any, NamedTuple

import nbformat
import pytest

from tests.notebooks.test_form import PROGRAMS, without_magic

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

REPOSITORY = Path(__file__).resolve().parent.parent.parent
ITEMS = tomllib.loads((Path(__file__).parent / "syllabus.toml").read_text())["item"]
TABLE = REPOSITORY / "artifacts" / "coverage.md"


class Place(NamedTuple):
    """Where an item is covered: the notebook, the cell's number from 1, and whether it runs there."""

    notebook: str
    cell: int
    live: bool


def shown(cell: Any) -> str:
    """The text a cell has put out."""
    outputs = (output.get("text", "") or output.get("data", {}).get("text/plain", "") for output in cell.outputs)
    return "\n".join(outputs)


def fits(cell: Any, item: dict[str, str]) -> bool:
    if "program" in item:
        found = without_magic(cell.source) == PROGRAMS[item["program"]]
    else:
        found = re.search(item["source"], cell.source) is not None
    return found and cell.execution_count is not None


def place_of(item: dict[str, str]) -> Place | None:
    path = (REPOSITORY / "notebooks" / f"{item['notebook']}.ipynb").resolve()
    if not path.is_file():
        return None
    cells = nbformat.read(path, as_version=4).cells
    name = path.relative_to(REPOSITORY).as_posix()
    prose = [number for number, cell in enumerate(cells, 1) if cell.cell_type == "markdown"]
    said = [number for number in prose if re.search(item.get("text", ""), cells[number - 1].source)]
    code = [(number, cell) for number, cell in enumerate(cells, 1) if cell.cell_type == "code"]
    if not said or not re.search(item.get("output", ""), "\n".join(shown(cell) for _, cell in code)):
        return None
    if "source" in item or "program" in item:
        # Exercises are handed out as they are, without outputs; nothing of them has run yet.
        live = [number for number, cell in code if fits(cell, item)]
        given = [number for number, cell in code if "exercises" in name and re.search(item["source"], cell.source)]
        return Place(name, (live or given)[0], live=True) if live or given else None
    return Place(name, said[0], live=False)


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item["name"])
def test_each_item_of_the_syllabus_has_its_cell(item: dict[str, str]) -> None:
    assert place_of(item) is not None, f"no cell of {item['notebook']} covers: {item['name']}"


def test_every_lesson_program_is_an_item() -> None:
    assert {item.get("program") for item in ITEMS} >= set(PROGRAMS)


def test_the_table_is_written() -> None:
    lines = ["| item of the syllabus | notebook | cell | |", "|---|---|---|---|"]
    for item in ITEMS:
        place = place_of(item)
        assert place is not None
        lines.append(f"| {item['name']} | {place.notebook} | {place.cell} | {'runs' if place.live else 'is said'} |")
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text("\n".join(lines) + "\n")
    assert len(TABLE.read_text().splitlines()) == len(ITEMS) + 2

"""Every item of the syllabus has its place in a lesson, in a cell that runs."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest

from tests.notebooks.test_form import PROGRAMS, without_magic

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

REPOSITORY = Path(__file__).resolve().parent.parent.parent
ITEMS = tomllib.loads((Path(__file__).parent / "syllabus.toml").read_text())["item"]


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


def is_covered(item: dict[str, str]) -> bool:
    path = (REPOSITORY / "notebooks" / f"{item['notebook']}.ipynb").resolve()
    if not path.is_file():
        return False
    cells = nbformat.read(path, as_version=4).cells
    said = [cell for cell in cells if cell.cell_type == "markdown" and re.search(item.get("text", ""), cell.source)]
    code = [cell for cell in cells if cell.cell_type == "code"]
    if not said or not re.search(item.get("output", ""), "\n".join(map(shown, code))):
        return False
    if "source" not in item and "program" not in item:
        return True
    # Exercises are handed out as they are, without outputs; nothing of them has run yet.
    handed_out = "exercises" in path.relative_to(REPOSITORY).parts
    return any(fits(cell, item) or (handed_out and re.search(item["source"], cell.source)) for cell in code)


@pytest.mark.parametrize("item", ITEMS, ids=lambda item: item["name"])
def test_each_item_of_the_syllabus_has_its_cell(item: dict[str, str]) -> None:
    assert is_covered(item), f"no cell of {item['notebook']} covers: {item['name']}"


def test_every_lesson_program_is_an_item() -> None:
    assert {item.get("program") for item in ITEMS} >= set(PROGRAMS)

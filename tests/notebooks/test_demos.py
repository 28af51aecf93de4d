"""Each demo fails before its repair, and works after it; what is for the speaker stays off the page for the class."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

from course_kit.authoring import edition_plan
from course_kit.presentation import preparing

REPOSITORY = Path(__file__).resolve().parent.parent.parent
DEMOS = sorted((REPOSITORY / "notebooks/demos").glob("*.ipynb"))

demos = pytest.mark.parametrize("path", DEMOS, ids=lambda path: path.stem)


def read(path: Path) -> Any:
    return nbformat.read(path, as_version=4)


def run(notebook: Any, folder: Path) -> Any:
    NotebookClient(notebook, timeout=200, resources={"metadata": {"path": str(folder)}}).execute()
    return notebook


def verdicts(notebook: Any) -> list[str]:
    """What a demo prints of how it went."""
    said = [output.get("text", "") for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    return [line[: line.index(":")] for text in said for line in text.splitlines() if line.startswith("It ")]


@pytest.mark.answers
@demos
def test_it_fails_first_and_works_after_its_repair(path: Path) -> None:
    """As it is stored; nbval runs it and compares."""
    assert verdicts(read(path)) == ["It fails", "It works"]


@pytest.mark.answers
@pytest.mark.parametrize("path", DEMOS[::3], ids=lambda path: path.stem)
def test_the_repair_in_place_of_the_failing_cell_is_all_it_takes(path: Path, domain: int) -> None:
    assert domain
    notebook = preparing.project_notebook(read(path))
    failing = [cell for cell in notebook.cells if cell.metadata.get(preparing.OURS)]
    assert len(failing) == 1
    failing[0].source = failing[0].metadata[preparing.OURS][preparing.REPAIRED]
    assert verdicts(run(notebook, path.parent)) == ["It works"]


def test_the_student_edition_shows_the_failure_without_the_answer(domain: int) -> None:
    assert domain
    notebook = edition_plan.remove_answers(read(DEMOS[0]))
    assert verdicts(notebook) == ["It fails"]
    assert verdicts(run(notebook, DEMOS[0].parent)) == ["It fails"]
    assert not any(preparing.repairs_of(cell) for cell in notebook.cells)


@pytest.mark.answers
@demos
def test_a_class_sees_neither_notes_nor_remarks_nor_outputs(path: Path) -> None:
    whole, shown = read(path), preparing.project_notebook(read(path))
    left = {cell.id for cell in shown.cells}
    remarks = [cell for cell in whole.cells if cell.metadata.get("tags") or cell.metadata.get("slideshow")]
    assert len(remarks) > 5
    assert left.isdisjoint(cell.id for cell in remarks)
    assert not any(cell.outputs or cell.execution_count for cell in shown.cells if cell.cell_type == "code")
    text = str([(cell.source, cell.metadata) for cell in shown.cells])
    assert not [cell.source for cell in remarks if cell.cell_type == "markdown" and cell.source[:40] in text]
    nbformat.validate(shown)


@pytest.mark.answers
@demos
def test_the_speaker_has_notes_for_the_beginning_and_the_repair_and_a_time(path: Path) -> None:
    spoken = preparing.speaker_script(read(path))
    assert spoken[0].notes
    assert [bool(cell.notes) for cell in spoken if cell.kind == "repair"] == [True]
    assert preparing.talk_minutes(read(path)) > 0
    assert all(cell.label for cell in spoken)
    shown = [cell.id for cell in preparing.project_notebook(read(path)).cells]
    assert [cell.cell_id for cell in spoken if cell.kind != "repair"] == shown

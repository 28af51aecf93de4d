"""Each demo fails as it stands, and works when its one line is switched."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

from course_kit.authoring import edition_notebooks
from course_kit.cli import present

REPOSITORY = Path(__file__).resolve().parent.parent.parent
DEMOS = sorted((REPOSITORY / "notebooks/demos").glob("*.ipynb"))
SWITCH = "REPAIRED = False"

demos = pytest.mark.parametrize("path", DEMOS, ids=lambda path: path.stem)


def run(notebook: Any, folder: Path) -> Any:
    NotebookClient(notebook, timeout=60, resources={"metadata": {"path": str(folder)}}).execute()
    return notebook


def verdict(notebook: Any) -> str:
    """What a demo prints of how it went."""
    said = [output.get("text", "") for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    lines = [line for text in said for line in text.splitlines() if line.startswith("It ")]
    assert len(lines) == 1
    return lines[0]


@pytest.mark.answers
@demos
def test_it_fails_as_it_stands_and_the_switch_repairs_it(path: Path, domain: int) -> None:
    """nbval runs it as it stands; here it is run with its one line switched."""
    assert domain
    notebook = nbformat.read(path, as_version=4)
    assert verdict(notebook).startswith("It fails:")
    switches = [cell for cell in notebook.cells if cell.source == SWITCH]
    assert len(switches) == 1
    switches[0].source = "REPAIRED = True"
    assert verdict(run(notebook, path.parent)).startswith("It works:")


def test_the_student_edition_shows_the_failure_without_the_answer(domain: int) -> None:
    assert domain
    notebook = edition_notebooks.without_answers(nbformat.read(DEMOS[0], as_version=4))
    assert verdict(run(notebook, DEMOS[0].parent)).startswith("It fails:")


@pytest.mark.answers
@demos
def test_it_has_an_answer_to_fold_away(path: Path) -> None:
    shown = present.for_a_class(nbformat.read(path, as_version=4))
    folded = [cell for cell in shown.cells if cell.metadata.get("jupyter", {}).get("source_hidden")]
    assert len(folded) == 1
    assert not any(cell.outputs for cell in shown.cells if cell.cell_type == "code")


def test_a_class_never_sees_what_the_one_before_has_typed(tmp_path: Path) -> None:
    stage = tmp_path / "stage"
    present.prepare(REPOSITORY, stage)
    demo = stage / present.FIRST_DEMO
    fresh = demo.read_text()
    demo.write_text(fresh.replace("Doubler", "Tripler"))
    (stage / "notebooks/Untitled.ipynb").write_text("{}")
    present.prepare(REPOSITORY, stage)
    assert demo.read_text() == fresh
    assert not (stage / "notebooks/Untitled.ipynb").exists()
    themes = stage / "settings/@jupyterlab/apputils-extension/themes.jupyterlab-settings"
    assert json.loads(themes.read_text())["overrides"]["code-font-size"] == "20px"

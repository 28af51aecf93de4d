"""What every notebook promises its reader, as far as it can be counted."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import nbformat
import pytest

REPOSITORY = Path(__file__).resolve().parent.parent.parent
CHECKPOINTS = ".ipynb_checkpoints"  # JupyterLab's own copies
LESSONS = sorted(path for path in (REPOSITORY / "notebooks").rglob("*.ipynb") if CHECKPOINTS not in path.parts)
EXERCISES = sorted(path for path in (REPOSITORY / "exercises").rglob("*.ipynb") if CHECKPOINTS not in path.parts)
PROGRAMS = {path.name: path.read_text().strip() for path in (REPOSITORY / "tests" / "lesson_programs").glob("*.py")}
LONGEST_CELL = 25

lessons = pytest.mark.parametrize("path", LESSONS, ids=lambda path: path.stem)
notebooks = pytest.mark.parametrize("path", [*LESSONS, *EXERCISES], ids=lambda path: path.stem)


def cells(path: Path, kind: str) -> list[Any]:
    return [cell for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == kind]


def text_of(path: Path) -> str:
    return "\n\n".join(cell.source for cell in cells(path, "markdown"))


def without_magic(source: str) -> str:
    first, _, rest = source.partition("\n")
    return rest.strip() if first.startswith("%%") else source.strip()


@notebooks
def test_it_is_a_valid_notebook_for_any_kernel_name(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert notebook.metadata.kernelspec.name == "python3"
    ids = [cell.id for cell in notebook.cells]
    assert len(set(ids)) == len(ids)


@notebooks
def test_no_cell_is_long(path: Path) -> None:
    """A complete program may be longer: its length is part of what is taught."""
    too_long = [
        cell.source
        for cell in cells(path, "code")
        if len(cell.source.splitlines()) > LONGEST_CELL
        and without_magic(cell.source) not in PROGRAMS.values()
        and not cell.source.startswith("%%submission")
    ]
    assert not too_long


@lessons
def test_it_begins_with_what_you_will_be_able_to_do_and_ends_with_a_check_of_it(path: Path) -> None:
    text = [cell.source for cell in cells(path, "markdown")]
    assert "you can" in text[0]
    assert any(re.search(r"^## .*Check yourself", part, re.MULTILINE) for part in text[-5:])


@lessons
def test_it_names_the_nodes_that_still_run_at_its_start_or_ends_its_own(path: Path) -> None:
    """A node that is left running would answer in the next notebook; a lesson's panels go on at its end."""
    code = cells(path, "code")
    assert code[0].source.splitlines()[-1] == "lab.nodes()" or "lab.stop()" in code[-1].source.splitlines()


@lessons
def test_its_outputs_are_stored_and_every_cell_was_run_in_order(path: Path) -> None:
    code = cells(path, "code")
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    assert any(cell.outputs for cell in code)


@lessons
def test_an_error_is_shown_only_where_one_is_announced(path: Path) -> None:
    for cell in cells(path, "code"):
        failed = any(output.output_type == "error" for output in cell.outputs)
        assert failed == ("raises-exception" in cell.metadata.get("tags", [])), cell.source


@lessons
def test_no_output_names_a_place_or_a_time_of_this_machine(path: Path) -> None:
    for cell in cells(path, "code"):
        shown = str(cell.outputs)
        assert not re.search(r"/(home|root|tmp|work)/|\b1[789]\d{8}\.\d+", shown), shown


@notebooks
def test_every_picture_has_a_text_and_every_link_leads_somewhere(path: Path) -> None:
    for cell in cells(path, "markdown"):
        assert "![](" not in cell.source
        for link in re.findall(r"\]\(((?!https?:|#)[^)\s]+)\)", cell.source):
            file, _, heading = link.partition("#")
            target = path.parent / file
            assert target.exists(), link
            if heading and target.suffix == ".ipynb":
                assert re.search(rf"^#+ +{re.escape(heading.replace('-', ' '))} *$", text_of(target), re.MULTILINE), (
                    link
                )


def test_lesson_one_runs_its_programs_word_for_word() -> None:
    sources = [without_magic(cell.source) for cell in cells(REPOSITORY / "notebooks/01_services.ipynb", "code")]
    assert PROGRAMS["minimal_service.py"] in sources
    assert PROGRAMS["minimal_client.py"] in sources


def words(text: str) -> int:
    """Words of prose, without links' targets, markup and programs."""
    prose = re.sub(r"```.*?```|<[^>]+>|\]\([^)]*\)", " ", text, flags=re.DOTALL)
    return len(re.findall(r"[A-Za-z']+", prose))


@pytest.mark.parametrize(
    "path", [path for path in LESSONS if path.parent.name == "notebooks"], ids=lambda path: path.stem
)
def test_the_reading_time_it_states_is_true(path: Path) -> None:
    """Prose at 200 words a minute, programs at half of that; a third more or less is still about right."""
    prose = [cell.source for cell in cells(path, "markdown")]
    stated = re.search(r"Reading takes about (\d+) minutes", " ".join(prose[0].split()))
    assert stated
    programs = sum(len(cell.source.split()) for cell in cells(path, "code"))
    minutes = sum(words(part) for part in prose) / 200 + programs / 100
    assert minutes / 1.34 < int(stated[1]) < minutes * 1.34

"""Every "Read on" leads to a heading that is there."""

from __future__ import annotations

import re
from pathlib import Path

import nbformat
import pytest

from course_kit.grading.diagnosis import catalogue

REPOSITORY = Path(__file__).resolve().parent.parent.parent
BROKEN = {path.stem for path in (REPOSITORY / "tests/broken/temperature_service").glob("*.py")}


def headings(path: Path) -> set[str]:
    text = "\n\n".join(cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "markdown")
    return set(re.findall(r"^#+ +(.+?) *$", text, re.MULTILINE))


@pytest.mark.parametrize("code", sorted(catalogue.catalogue()))
def test_a_link_into_a_notebook_that_exists_names_one_of_its_headings(code: str) -> None:
    found = catalogue.catalogue()[code]
    notebook = REPOSITORY / found.notebook
    message = catalogue.complete("It failed.", code)
    assert message.startswith(f"It failed. {found.explanation}")
    assert (found.link in message) == notebook.is_file()
    if notebook.is_file():
        assert found.section in headings(notebook)


def test_whatever_exercise_1_diagnoses_is_taught_somewhere() -> None:
    codes = BROKEN & set(catalogue.catalogue())
    assert len(codes) > 20
    assert all((REPOSITORY / catalogue.catalogue()[code].notebook).is_file() for code in codes)

"""Every "Read on" leads to a heading that is there."""

from __future__ import annotations

import html
import re
from pathlib import Path
from urllib.parse import quote

import nbformat
import pytest

from course_kit.grading import GradingError, engine, render_html, render_text
from course_kit.grading.model import catalogue
from course_kit.grading.model.exercise import list_exercise_ids, load_exercise
from course_kit.grading.model.report import Report

REPOSITORY = Path(__file__).resolve().parents[3]
OWN = [(name, code) for name in list_exercise_ids() for code in load_exercise(name).diagnoses]
RESULT = {
    "id": "some_check",
    "title": "Something works",
    "status": "failed",
    "max_points": 1.0,
    "sent": "1.0",
    "expected": "2.0",
    "got": "3.0",
    "message": "It failed.",
    "graph": None,
    "steps": [],
    "proves": [],
}


def headings(path: Path) -> set[str]:
    text = "\n\n".join(cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "markdown")
    return set(re.findall(r"^#+ +(.+?) *$", text, re.MULTILINE))


@pytest.mark.parametrize("code", sorted(catalogue.catalogue()))
def test_a_link_into_a_notebook_that_exists_names_one_of_its_headings(code: str) -> None:
    found = catalogue.catalogue()[code]
    notebook = REPOSITORY / found.notebook
    message = catalogue.complete_message("It failed.", found)
    assert message.startswith(f"It failed. {found.explanation}")
    assert (found.link in message) == notebook.is_file()
    if notebook.is_file():
        assert found.section in headings(notebook)


@pytest.mark.parametrize(("name", "code"), OWN)
def test_a_link_of_an_exercise_names_a_heading_of_its_notebook(name: str, code: str) -> None:
    found = load_exercise(name).diagnosis(code)
    assert found is not None
    assert found.section in headings(REPOSITORY / found.notebook)
    assert found != catalogue.catalogue()[code]


@pytest.mark.parametrize(("name", "code"), OWN)
def test_what_an_exercise_says_of_a_diagnosis_is_in_its_card_and_report(name: str, code: str) -> None:
    exercise = load_exercise(name)
    own, usual = exercise.diagnosis(code), catalogue.catalogue()[code]
    assert own is not None
    check = engine._check(exercise, {**RESULT, "diagnosis": code})
    report = Report(name, exercise.title, "a.py", "graded", False, 0.0, 1.0, 1.0, (check,))
    card = html.unescape(render_html(report, REPOSITORY))
    text = " ".join(render_text(report).split())
    for shown in (own.title, own.explanation, f"{own.notebook}#{quote(own.section.replace(' ', '-'))}"):
        assert shown in card
    assert own.explanation in text
    assert own.link in "".join(render_text(report, width=10_000).split("\n"))
    for one in ("explanation", "section"):
        if getattr(own, one) != getattr(usual, one):
            assert getattr(usual, one) not in card


def test_a_diagnosis_that_an_exercise_does_not_word_is_the_catalogues() -> None:
    exercise = load_exercise("temperature_service")
    assert exercise.diagnoses == {}
    assert exercise.diagnosis("name.node") == catalogue.catalogue()["name.node"]
    assert exercise.diagnosis(None) is exercise.diagnosis("no.such_code") is None


def test_a_diagnosis_of_the_task_itself_leads_to_the_notebook_of_the_exercise() -> None:
    for name in list_exercise_ids():
        exercise = load_exercise(name)
        found = exercise.diagnosis("math.formula")
        assert found is not None
        assert found.notebook == f"exercises/{name}/{exercise.notebook}"
        assert found.section in headings(exercise.folder / exercise.notebook) or not exercise.class_name


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (
            '[diagnoses."math.formulae"]\ntitle = "A"',
            "there is no diagnosis 'math.formulae'; did you mean math.formula?",
        ),
        ('[diagnoses."math.formula"]\nhint = "A"', "there is no setting 'hint' in diagnoses[...]"),
        ('[diagnoses."math.formula"]\ntitle = " "', "'title' of the diagnosis math.formula is empty"),
        (
            '[diagnoses."math.formula"]\nsection = 3',
            "'diagnoses[...].section' cannot be right: expected str | null, got int",
        ),
        ('[diagnoses."math.formula"]\nnotebook = "a.ipynb"', "names a notebook without a 'section' of it"),
        ("[diagnoses]\n'math.formula' = 'A'", "'diagnoses[...]' cannot be right: expected object, got str"),
        ("diagnoses = 3", "'diagnoses' cannot be right: expected object, got int"),
    ],
)
def test_a_mistake_in_an_exercises_diagnoses_is_named(table: str, said: str, tmp_path: Path) -> None:
    folder = tmp_path / "temperature_service"
    folder.mkdir()
    text = (REPOSITORY / "exercises/temperature_service/exercise.toml").read_text()
    (folder / "exercise.toml").write_text(f"{table}\n{text}" if table.startswith("diagnoses") else f"{text}\n{table}\n")
    with pytest.raises(GradingError, match=rf"exercise.toml cannot be used: .*{re.escape(said)}"):
        load_exercise("temperature_service", tmp_path)

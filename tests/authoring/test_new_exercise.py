"""`course-kit new exercise`: what it makes works at once, and is kept in step with its exercise.toml."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.authoring import check, new_exercise
from course_kit.cli.main import main
from course_kit.grading.model.exercise import Exercise, read_exercise
from course_kit.grading.model.exercise_folders import VARIABLE

ROOT = environment.checkout_folder() or Path()
FEW = 0.35  # of full marks, for a starter

pytestmark = pytest.mark.answers


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of somebody's exercises, which counts."""
    monkeypatch.setenv(VARIABLE, str(tmp_path / "mine"))
    return tmp_path / "mine"


def make(folder: Path, kind: str = "topic", name: str = "dead_band") -> Exercise:
    return new_exercise.create_exercise(name, kind, folder)


@pytest.mark.parametrize("kind", new_exercise.KINDS)
def test_what_is_made_is_proven_by_its_own_set(kind: str, mine: Path) -> None:
    """Really graded: the starter and its notebook, the solution, a right program, a wrong one, and slips."""
    exercise = make(mine, kind, f"my_{kind}")
    found = check.check_proofs(ROOT, [exercise.id])
    assert [str(one) for one in found.faults] == []
    scores = {(one.kind, one.name): report.score / exercise.points for one, report in found.reports.items()}
    assert {purpose for purpose, _ in scores} == {"starter", "solution", "variant", "broken", "slip"}
    for (purpose, name), share in scores.items():
        if purpose in ("solution", "variant"):
            assert share == 1.0, name
        else:
            assert share < (FEW if purpose == "starter" else 1.0), name


def test_a_fault_of_the_proof_set_is_found(mine: Path) -> None:
    """The same proof, red: a wrong program that gets full marks, and a slip that is seen by another check."""
    exercise = make(mine)
    proof = exercise.folder / "proof"
    shutil.copy(exercise.solution, proof / "broken" / "unchanged.py")
    slips = (proof / "slips.toml").read_text()
    (proof / "slips.toml").write_text(slips.replace('failed = { doubled = "" }', 'failed = { offered = "" }'))
    found = check.check_proofs(ROOT, [exercise.id])
    faults = {(one.rule, one.submission) for one in found.faults}
    assert {("broken", "broken proof/broken/unchanged.py"), ("slips", "slip twice (proof/slips.toml)")} <= faults


def test_sentences_and_starter_are_written_anew_and_what_the_author_added_stays(mine: Path) -> None:
    exercise = make(mine)
    toml, starter, notebook = (
        exercise.folder / name for name in ("exercise.toml", exercise.starter, exercise.notebook)
    )
    text = toml.read_text().replace("is published doubled", "comes back twice as large")
    toml.write_text(text.replace("A node that doubles numbers", "Twice"))
    starter.write_text(starter.read_text().replace("# Your code goes here.", "# Yours."))
    content = json.loads(notebook.read_text())
    content["cells"].insert(1, {"cell_type": "markdown", "id": "own", "metadata": {}, "source": ["My own words."]})
    notebook.write_text(json.dumps(content))
    assert set(new_exercise.refresh_exercise(read_exercise(exercise.folder))) == {starter, notebook}
    assert "comes back twice as large" in starter.read_text()
    assert starter.read_text().startswith('"""Twice.\n')
    cells = {cell["id"]: "".join(cell["source"]) for cell in json.loads(notebook.read_text())["cells"]}
    assert list(cells)[:3] == ["title", "own", "task"]
    assert cells["own"] == "My own words."
    assert "comes back twice as large" in cells["task"]
    assert cells["title"] == "# Twice\n\n5 points, 3 to pass."
    assert cells["answer"].startswith("%%submission dead_band\nimport rclpy\n")
    assert cells["answer"].endswith("# Yours.")
    assert new_exercise.refresh_exercise(read_exercise(exercise.folder)) == []


def test_nothing_that_is_there_is_written_over(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "dead_band").mkdir()
    assert main(["new", "exercise", "dead_band", "--topic", "--in", str(tmp_path)]) == 2
    assert f"{tmp_path}/dead_band exists already." in capsys.readouterr().err
    assert main(["new", "exercise", "temperature_service", "--topic", "--in", str(tmp_path)]) == 2
    assert "There is an exercise 'temperature_service' already" in capsys.readouterr().err
    (tmp_path / "file").touch()
    assert main(["new", "exercise", "dead_band", "--topic", "--in", str(tmp_path / "file")]) == 2
    assert "could not be read or written" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["dead_band", "file"]


def test_the_word_exercise_is_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["new", "dead_band", "--service"])
    assert "write `exercise` after `new`: ./course new exercise NAME" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("file", "old", "new", "sentence"),
    [
        ("dead_band.ipynb", '"id": "answer"', '"id": "other"', "has no cell with the id 'answer'"),
        ("dead_band.ipynb", '"cells"', '"no cells"', "is not a notebook"),
        ("dead_band.py", '"""A node', "x = 1\n" + '"""A node', "does not begin with a docstring"),
    ],
)
def test_what_cannot_be_written_anew_is_a_sentence(  # noqa: PLR0913, PLR0917 - a table of cases
    file: str, old: str, new: str, sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make(tmp_path)
    path = tmp_path / "dead_band" / file
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    assert main(["new", "exercise", "dead_band", "--refresh", "--in", str(tmp_path)]) == 2
    assert sentence in capsys.readouterr().err

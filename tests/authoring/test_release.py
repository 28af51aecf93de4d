"""The student edition: what is in it, what is not, and that it works by itself."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import nbformat
import pytest

from course_kit import environment
from course_kit.authoring import release

REPOSITORY = Path(__file__).resolve().parent.parent
HELPER = "course_kit/interfaces/native/_helper.so"  # built by the set-up, in the student edition as here

pytestmark = pytest.mark.answers


@pytest.fixture(scope="module")
def student(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = release.make(tmp_path_factory.mktemp("release") / "student edition")
    shutil.copy2(REPOSITORY / HELPER, made / HELPER)
    return made


def run(student: Path, *command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", *command],
        cwd=student,
        env=environment.child_environment(PYTHONPATH=str(student)),
        capture_output=True,
        text=True,
        timeout=110,
        check=False,
    )


def test_it_has_the_course_and_none_of_the_answers(student: Path) -> None:
    for name in ("course", "pyproject.toml", "README.md", "notebooks/01_services.ipynb", "tests/conftest.py"):
        assert (student / name).is_file(), name
    assert os.access(student / "course", os.X_OK)
    for name in release.LEFT_OUT:
        assert not (student / name).exists(), name
    for path in REPOSITORY.glob("course_kit/**/templates/*"):
        assert (student / path.relative_to(REPOSITORY)).is_file(), path
    answers = {path.read_bytes() for path in REPOSITORY.glob("solutions/*/*.*")}
    assert answers
    assert not [path for path in student.rglob("*") if path.is_file() and path.read_bytes() in answers]


def test_its_own_tests_are_found_and_those_of_the_notebooks_pass(student: Path) -> None:
    found = run(student, "pytest", "--collect-only", "-q")
    assert found.returncode == 0, found.stdout[-3000:]
    passed = run(student, "pytest", "-q", "tests/notebooks", "tests/quiz", "tests/robot")
    assert passed.returncode == 0, passed.stdout[-3000:]
    assert "test_form" in found.stdout
    assert "test_release" not in found.stdout


def test_a_learner_is_graded_in_it(student: Path) -> None:
    starter = "exercises/temperature_service/temperature_service.py"
    graded = run(student, "course_kit", "grade", "temperature_service", starter, "--format", "json")
    assert json.loads(graded.stdout)["status"] == "graded", graded.stderr
    assert graded.returncode == 1


def test_a_zip_holds_the_same_and_keeps_the_door_executable(student: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(release.make(tmp_path / "student.ZIP")) as packed:
        names = {name.removeprefix(f"{release.NAME}/") for name in packed.namelist()}
        assert packed.getinfo(f"{release.NAME}/course").external_attr >> 16 & 0o111
    assert names == set(release.contents(REPOSITORY))
    assert all((student / name).is_file() for name in names)


def test_cells_tagged_answer_are_left_out_and_the_others_numbered_anew() -> None:
    cell = nbformat.v4.new_code_cell
    result = nbformat.v4.new_output("execute_result", {"text/plain": "3"}, execution_count=3)
    notebook = nbformat.v4.new_notebook(
        cells=[
            cell("broken()", execution_count=1),
            cell("repaired()", execution_count=2, metadata={"tags": ["answer"]}),
            cell("later()"),
            cell("1 + 2", execution_count=3, outputs=[result]),
        ]
    )
    kept = release.without_answers(notebook).cells
    assert [one.source for one in kept] == ["broken()", "later()", "1 + 2"]
    assert [one.execution_count for one in kept] == [1, None, 2]
    assert kept[2].outputs[0].execution_count == 2


def test_it_never_writes_over_anything(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "work.txt").write_text("mine")
    taken = tmp_path / "taken.zip"
    taken.write_bytes(b"mine")
    assert release.run(str(tmp_path)) == 2
    assert release.run(str(taken)) == 2
    assert "choose another name" in capsys.readouterr().err
    assert taken.read_bytes() == b"mine"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["taken.zip", "work.txt"]


def test_what_cannot_be_written_is_said_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").touch()
    assert release.run(str(tmp_path / "file" / "student")) == 2
    said = capsys.readouterr().err
    assert said.startswith("course-kit: the student edition could not be written: ")
    assert "Errno" not in said


def test_without_git_what_was_generated_stays_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in (
        "notebooks/a.ipynb",
        "exercises/b/b.py",
        ".venvs/wheels-1/x.py",
        "course_kit/__pycache__/c.pyc",
        "student.zip",
        "student/course_kit/cli/main.py",
        "solutions/s.py",
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("{}")
    (tmp_path / ".venv").symlink_to("nowhere")  # as after somebody has removed .venvs
    monkeypatch.setattr(release.shutil, "which", lambda _name: None)
    assert release.contents(tmp_path) == ["exercises/b/b.py", "notebooks/a.ipynb"]

"""A learner's folder: what opens in it, and what an update of the course does to a learner's files."""

from __future__ import annotations

import json
import os
import subprocess
from typing import TYPE_CHECKING, Any

import pytest
from ipykernel.ipkernel import IPythonKernel

from course_kit import environment
from course_kit.environment import LEARNER_FOLDER
from course_kit.learner import workspace
from tests.course_copy import REPOSITORY, TEMPERATURE, Course, copy_course, starter

if TYPE_CHECKING:
    from pathlib import Path

LESSON = "notebooks/01_lesson.ipynb"
PROGRAM = f"exercises/{TEMPERATURE}/{TEMPERATURE}.py"


def notebook(source: str, output: str = "") -> bytes:
    outputs = [{"output_type": "stream", "name": "stdout", "text": [output]}] if output else []
    cell = {"cell_type": "code", "id": "one", "metadata": {}, "source": [source], "outputs": outputs}
    cell["execution_count"] = 1 if output else None
    metadata = {"language_info": {"name": "python"}}
    return json.dumps({"cells": [cell], "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}).encode()


def given(*sources: tuple[str, str]) -> dict[str, bytes]:
    return {path: workspace.clear_for_learner(path, notebook(source)) for path, source in sources}


def cell_of(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text())["cells"][0]
    return found


def test_a_notebook_opens_without_outputs_and_jupyterlab_has_nothing_to_add() -> None:
    opened = json.loads(workspace.clear_for_learner(LESSON, notebook("1 + 1", "2")))
    assert opened["cells"][0]["outputs"] == []
    assert opened["cells"][0]["execution_count"] is None
    assert opened["metadata"]["language_info"] == IPythonKernel.language_info
    for other in (b"no notebook", b'{"cells": [1]}', b"[]"):
        assert workspace.clear_for_learner(LESSON, other) == other
    assert workspace.clear_for_learner("a.py", b"x = 1\n") == b"x = 1\n"


def test_what_was_not_changed_becomes_the_new_version(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    workspace.bring_up_to_date(folder, given((LESSON, "old")))
    (folder / LESSON).write_bytes(notebook("old", "it was run"))
    assert workspace.bring_up_to_date(folder, given((LESSON, "old"))) == []
    assert cell_of(folder / LESSON)["outputs"], "an update without news takes away what the cells have shown"
    assert workspace.bring_up_to_date(folder, given((LESSON, "new"))) == [
        f"New version of {LESSON}; you had not changed the old one."
    ]
    assert cell_of(folder / LESSON)["source"] == ["new"]


def test_what_was_changed_stays_and_the_new_version_lies_beside_it_once(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    workspace.bring_up_to_date(folder, given((LESSON, "old")))
    (folder / LESSON).write_bytes(notebook("mine"))
    assert workspace.bring_up_to_date(folder, given((LESSON, "old"))) == []
    [said] = workspace.bring_up_to_date(folder, given((LESSON, "new")))
    assert "01_lesson.new-version.ipynb" in said
    assert cell_of(folder / LESSON)["source"] == ["mine"]
    assert cell_of(folder / "notebooks/01_lesson.new-version.ipynb")["source"] == ["new"]
    assert workspace.bring_up_to_date(folder, given((LESSON, "new"))) == []
    (folder / "notebooks/01_lesson.new-version.ipynb").write_bytes(notebook("mine, too"))
    workspace.bring_up_to_date(folder, given((LESSON, "newest")))
    assert cell_of(folder / "notebooks/01_lesson.new-version.ipynb")["source"] == ["mine, too"]
    assert cell_of(folder / "notebooks/01_lesson.new-version-2.ipynb")["source"] == ["newest"]


def test_what_was_deleted_comes_back_only_as_a_new_version_or_when_asked_for(tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    workspace.bring_up_to_date(folder, given((LESSON, "old")))
    (folder / LESSON).unlink()
    workspace.bring_up_to_date(folder, given((LESSON, "old")))
    assert not (folder / LESSON).exists()
    workspace.bring_up_to_date(folder, given((LESSON, "old")), restore=True)
    assert (folder / LESSON).exists()
    (folder / LESSON).unlink()
    workspace.bring_up_to_date(folder, given((LESSON, "new")))
    assert cell_of(folder / LESSON)["source"] == ["new"]


@pytest.mark.parametrize("damage", ["{", '{"handed_out": 1}'])
def test_a_damaged_manifest_costs_no_work(damage: str, tmp_path: Path) -> None:
    folder = tmp_path / "mine"
    workspace.bring_up_to_date(folder, given((LESSON, "old")))
    (folder / LESSON).write_bytes(notebook("mine"))
    (folder / environment.paths.MANIFEST).write_text(damage)
    workspace.bring_up_to_date(folder, given((LESSON, "old")))
    assert cell_of(folder / LESSON)["source"] == ["mine"]


@pytest.fixture
def clone(tmp_path: Path) -> Course:
    course = copy_course(tmp_path)
    (course.root / "notebooks" / "01_lesson.ipynb").write_bytes(notebook("ours", "stored"))
    for command in (["init", "-q"], ["add", "exercises", "notebooks"], ["commit", "-q", "-m", "a course"]):
        subprocess.run(
            ["git", "-c", "user.name=a", "-c", "user.email=a@b.c", *command], cwd=course.root, check=True, timeout=60
        )
    return course


def test_the_folder_in_a_clone_is_the_learners_and_git_ignores_it(clone: Course) -> None:
    made = clone.run("copy")
    assert made.returncode == 0, made.stderr
    folder = clone.root / LEARNER_FOLDER
    assert cell_of(folder / LESSON)["source"] == ["ours"]
    assert (folder / PROGRAM).read_bytes() == starter(clone.root.parent).read_bytes()
    (folder / LESSON).write_bytes(notebook("mine", "run"))
    (folder / PROGRAM).write_text("print('mine')\n")
    assert not list(folder.rglob("solution*"))
    status = subprocess.run(
        ["git", "status", "--porcelain", "."], cwd=clone.root, capture_output=True, text=True, check=True
    )
    assert LEARNER_FOLDER not in status.stdout
    again = clone.run("copy")
    assert again.stderr == ""
    assert cell_of(folder / LESSON)["source"] == ["mine"]
    # Commands find the learner's files from anywhere in the clone.
    assert f"{LEARNER_FOLDER}/exercises/{TEMPERATURE}" in clone.run("list").stdout
    assert clone.run("reset", TEMPERATURE).returncode == 0
    assert (folder / PROGRAM).read_bytes() == (clone.root / PROGRAM).read_bytes()
    exercise_notebook = (folder / PROGRAM).with_suffix(".ipynb")
    exercise_notebook.unlink()
    assert clone.run("reset", TEMPERATURE).returncode == 0
    assert json.loads(exercise_notebook.read_text())["metadata"]["language_info"] == IPythonKernel.language_info
    assert f"grading {LEARNER_FOLDER}/{PROGRAM}" in clone.run("grade", TEMPERATURE).stderr


def test_the_authors_folder_is_no_learners(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """`./course lab .` opens the course's own folder, and copies nothing."""
    from course_kit.integrations import jupyter

    served = []

    def stand_in(folder: Path, opens: str, arguments: list[str]) -> tuple[list[str], dict[str, str]]:
        served.append((folder, opens, arguments))
        return [], {}

    monkeypatch.setattr(jupyter, "lab_command", stand_in)
    monkeypatch.setattr(os, "execve", lambda *_: 0)
    monkeypatch.setattr(workspace, "make_copy", lambda *_, **__: pytest.fail("it was copied"))
    jupyter.run_lab([str(REPOSITORY), "--no-browser"])
    assert served == [(REPOSITORY, f"/lab/tree/{jupyter.FIRST_LESSON}", ["--no-browser"])]
    for wrong in (REPOSITORY / "notebooks", REPOSITORY / "README.md"):  # a copy in there would become a part of it
        assert jupyter.run_lab([str(wrong)]) == 2
        assert "cannot be your folder" in capsys.readouterr().err
    assert len(served) == 1

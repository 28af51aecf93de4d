"""An exercise of an instructor's folder in a notebook, with nbgrader and Otter, and in the commands of a learner."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.cli.main import main
from course_kit.interfaces.sources import PATH_VARIABLE
from course_kit.learner import progress
from tests import outside_exercises
from tests.lab.kernel import Kernel
from tests.outside_exercises import ID, SOLUTION, STARTER

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    made = outside_exercises.write(tmp_path / "mine")
    monkeypatch.setenv("COURSE_EXERCISES", str(tmp_path / "mine"))
    monkeypatch.setenv(PATH_VARIABLE, "")  # loading checks into this process changes it
    monkeypatch.setenv(progress.VARIABLE, str(tmp_path / "progress.json"))
    return made


@pytest.mark.usefixtures("mine", "domain")
def test_a_notebook_has_its_types_grades_it_and_gives_hints(tmp_path: Path) -> None:
    with Kernel(cwd=tmp_path) as kernel:
        assert kernel.run("%load_ext course_kit").ok
        imported = kernel.run("from three_interfaces.srv import Three\nprint(Three.Request(a=1).a)")
        assert imported.stdout == "1\n", imported.error
        assert kernel.run(f"%%submission {ID}\n{STARTER}").ok
        graded = kernel.run(f"%grade {ID}")
        assert "A service that adds three numbers" in graded.result["text/plain"], graded.stderr
        assert "1 of 3 points" in graded.result["text/plain"]
        assert "A sum has three parts here." in kernel.run(f"%hint {ID}").stdout
        assert kernel.run(f"%%submission {ID}\n{SOLUTION}").ok
        pointed = kernel.run(f"from course_kit import nbgrader\nnbgrader.points('{ID}')")
        assert pointed.result["text/plain"] == "3", pointed.stdout
        asked = kernel.run("%grade")
        assert f"Exercises: {ID}, " in asked.stderr


@pytest.mark.usefixtures("mine")
def test_the_commands_of_a_learner_know_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    begun = tmp_path / "begun"
    assert main(["reset", ID, str(begun)]) == 0
    assert (begun / "add_three.py").read_text() == STARTER
    assert main(["solution", ID]) == 1
    capsys.readouterr()
    assert main(["solution", ID, "--show"]) == 0
    assert capsys.readouterr().out == SOLUTION
    assert main(["otter", ID]) == 0
    cases = capsys.readouterr().out
    assert "The service is there" in cases
    assert "It adds" in cases

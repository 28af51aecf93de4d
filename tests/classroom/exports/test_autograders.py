"""What platforms' autograders get from us: their results in their formats, and the archives that they start."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import zipfile
from datetime import datetime, timezone
from typing import TYPE_CHECKING

import pytest

from course_kit.authoring import autograders
from course_kit.classroom import autograder
from course_kit.classroom.exports import autograder_results
from course_kit.classroom.exports.texts import json_text
from course_kit.cli.main import main
from tests.classroom.exports import rules
from tests.classroom.exports.books import SERVICE, bad, good, unreadable
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.records import GradeRecord

BROKEN = REPOSITORY / "tests/broken/temperature_service/service.exception.py"
RUNNER = {
    "CLASSROOM": "ros-2026",
    "ASSIGNMENT": "temperature",
    "SUBMISSION_TAG": "submit/2026-11-22T10-00-00Z-abc1234",
    "COMMIT_URL": "https://example.org/c",
    "RELEASE_URL": "https://example.org/r",
    "OWNER": "jane",
}
NOW = datetime(2026, 11, 22, 10, 0, tzinfo=timezone.utc)


def of_classroom50(one: GradeRecord) -> dict[str, object]:
    return rules.classroom50(json_text(autograder_results.classroom50_result(one, RUNNER, NOW)))


@pytest.mark.parametrize(("maker", "score"), [(good, 100), (bad, 0), (unreadable, 0)])
def test_classroom_50_gets_whole_numbers(maker: object, score: int) -> None:
    result = of_classroom50(maker("jane"))  # type: ignore[operator]
    assert (result["score"], result["max-score"]) == (score, 100)
    assert (result["owner"], result["datetime"]) == ("jane", "2026-11-22T10:00:00Z")


def test_outside_of_its_runner_it_says_what_is_missing_before_anything_is_graded(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in RUNNER:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("CLASSROOM", "x")
    assert main(["grade", SERVICE.id, str(BROKEN), "--format", "classroom50"]) == 2
    said = capsys.readouterr().err
    assert "here ASSIGNMENT, SUBMISSION_TAG, COMMIT_URL, RELEASE_URL are missing" in said


@pytest.fixture(scope="module")
def handed_in(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A checkout as a platform hands it over: the program deep within, a folder of git, a pipe."""
    folder = tmp_path_factory.mktemp("submission")
    (folder / ".git").mkdir()
    (folder / ".git" / "temperature_service.py").write_text("raise SystemExit\n")
    (folder / "src").mkdir()
    shutil.copy(BROKEN, folder / "src" / "temperature_service.py")
    (folder / "README.md").write_text("mine\n")
    os.mkfifo(folder / "pipe.py")
    return folder


def test_gradescope_and_classroom_50_grade_a_folder_and_end_with_0(
    handed_in: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Though the score is below the pass mark: anything else would be a fault of the autograder."""
    for name, value in RUNNER.items():
        monkeypatch.setenv(name, value)
    results = {}
    for kind in ("gradescope", "classroom50"):
        target = tmp_path / kind / "results.json"
        done = subprocess.run(
            [
                *(sys.executable, "-m", "course_kit", "grade", SERVICE.id, str(handed_in)),
                *("--seed", "7", "--format", kind, "--to", str(target)),
            ],
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )
        assert (done.returncode, done.stdout) == (0, ""), done.stderr
        results[kind] = target.read_text()
    there = rules.gradescope(results["gradescope"])
    assert there["extra_data"] == {"exercise": SERVICE.id, "seed": 7}
    assert 0 < there["score"] < SERVICE.pass_mark
    assert rules.classroom50(results["classroom50"])["score"] == round(10 * there["score"])


def test_a_folder_without_a_program_is_0_points_with_a_reason(tmp_path: Path) -> None:
    (tmp_path / "essay.txt").write_text("I did not.")
    (tmp_path / "essay.pdf").write_text("Nor did I.")
    empty = tmp_path / "empty"
    empty.mkdir()
    for folder in (tmp_path, empty):
        found = autograder.grade_path(SERVICE.id, folder)
        assert (found.status, found.score) == ("unreadable", 0.0)
        assert "Hand in temperature_service.py or temperature_service.ipynb." in found.report["stderr"]


def test_a_fault_of_the_grader_is_no_result(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "results.json"
    assert main(["grade", "no_such_exercise", str(tmp_path), "--format", "gradescope", "--to", str(target)]) == 2
    assert "no_such_exercise" in capsys.readouterr().err
    assert not target.exists()


@pytest.mark.parametrize("arguments", [["--attach"], ["--exec", "true"], []])
def test_only_what_was_handed_in_is_graded_for_a_platform(
    arguments: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["grade", SERVICE.id, *arguments, "--format", "gradescope"]) == 2
    assert "Name the file or folder." in capsys.readouterr().err


def test_the_zip_for_gradescope_has_its_scripts_at_the_root_and_the_kit_without_answers(tmp_path: Path) -> None:
    path = autograders.write_gradescope(SERVICE.id, tmp_path / "autograder.zip")
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        for script in ("setup.sh", "run_autograder", "ros2-course/course"):
            assert archive.getinfo(script).external_attr >> 16 & 0o111, script
            assert archive.read(script).startswith(b"#!")
        run = archive.read("run_autograder").decode()
        archive.extract("setup.sh", tmp_path)
        archive.extract("run_autograder", tmp_path)
    assert f"grade {SERVICE.id} /autograder/submission" in run
    assert "--to /autograder/results/results.json" in run
    assert {name.split("/")[1] for name in names if "/" in name} == {
        "LICENSE", "README.md", "course", "course_kit", "course_setup", "exercises", "hatch_build.py", "notebooks",
        "pyproject.toml",
    }  # fmt: skip
    assert not [name for name in names if "__pycache__" in name or name.endswith(".so") or "solutions" in name]
    for script in ("setup.sh", "run_autograder"):
        subprocess.run(["bash", "-n", str(tmp_path / script)], check=True, timeout=20)


def test_the_folder_for_classroom_50_grades_with_the_kit_beside_it(tmp_path: Path) -> None:
    """Its script unpacks the kit and calls it; a stand-in for the kit tells with what."""
    folder = autograders.write_classroom50(SERVICE.id, tmp_path / "temperature", seed=5)
    assert {path.name for path in folder.iterdir()} == {"autograder.py", "kit.zip", "runtime.json"}
    assert (folder / "kit.zip").stat().st_size < 10 * 1024**2, "its runner fetches no more"
    assert json.loads((folder / "runtime.json").read_text())["python"] == "3.12"
    with zipfile.ZipFile(folder / "kit.zip") as archive:
        assert {"ros2-course/course", "ros2-course/exercises/temperature_service/exercise.toml"} <= set(
            archive.namelist()
        )
    with zipfile.ZipFile(folder / "kit.zip", "w") as stand_in:
        stand_in.writestr("ros2-course/course", 'echo "$@" > called; exit 3\n')
    done = subprocess.run([sys.executable, folder / "autograder.py"], cwd=tmp_path, check=False, timeout=60)
    assert done.returncode == 3
    told = (tmp_path / "called").read_text().strip()
    assert told == f"grade {SERVICE.id} . --seed=5 --format classroom50 --to result.json"


@pytest.mark.parametrize("where", ["beside the script", "where it is called"])
def test_the_script_of_classroom_50_loads_nothing_of_a_students(where: str, tmp_path: Path) -> None:
    """Whatever a workflow copies where. An empty entry of PYTHONPATH means the folder in which it is called."""
    folder = autograders.write_classroom50(SERVICE.id, tmp_path / "temperature")
    with zipfile.ZipFile(folder / "kit.zip", "w") as stand_in:
        stand_in.writestr("ros2-course/course", "exit 3\n")
    called = tmp_path / "checkout"
    called.mkdir()
    for name in ("pathlib", "subprocess", "tempfile", "zipfile", "random", "shutil", "signal", "struct"):
        trap = (folder if where == "beside the script" else called) / f"{name}.py"
        trap.write_text(f"open({str(tmp_path / 'loaded')!r}, 'a').write(__name__)\n")
    done = subprocess.run(
        [sys.executable, "-S", folder / "autograder.py"],  # packages may load modules before the script begins
        cwd=called,
        env={**os.environ, "PYTHONPATH": os.pathsep},
        check=False,
        timeout=60,
    )
    assert done.returncode == 3
    assert not (tmp_path / "loaded").exists(), (tmp_path / "loaded").read_text()

"""A class with an exercise of an instructor's own folder, beside one of the course: everything that `class` does."""

from __future__ import annotations

import csv
import io
import json
import subprocess
import sys
from pathlib import Path

import pytest

from course_kit import environment
from tests import outside_exercises
from tests.outside_exercises import ID, SOLUTION, STARTER

OF_COURSE = "temperature_service"
WRONG = SOLUTION.replace("+ request.c", "- request.c")

pytestmark = [pytest.mark.answers, pytest.mark.timeout(240)]


def course_kit(*words: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "course_kit", *map(str, words)]
    environ = environment.child_environment(COURSE_EXERCISES="")
    return subprocess.run(command, env=environ, capture_output=True, text=True, timeout=200, check=False)


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    return outside_exercises.write(tmp_path / "mine")


@pytest.fixture
def handed_in(tmp_path: Path) -> Path:
    """Ann is right, Ben wrong, and found by the class's name alone; Cem has handed in the starter as it was."""
    files = {
        "ann/add_three.py": SOLUTION,
        f"ann/{OF_COURSE}.py": (
            Path(str(environment.checkout_folder())) / f"solutions/{OF_COURSE}/{OF_COURSE}.py"
        ).read_text(),
        "ben/work.py": WRONG,
        "cem/add_three.py": STARTER,
    }
    for name, text in files.items():
        path = tmp_path / "in" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path / "in"


def run(mine: Path, handed_in: Path, *more: object) -> subprocess.CompletedProcess[str]:
    out = handed_in.parent / "out"
    exercises = ("--exercise", ID, "--exercise", OF_COURSE, "--exercises", mine)
    return course_kit("class", handed_in, "--out", out, *exercises, *more)


def rows(path: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8-sig"))))


def scores(out: Path) -> dict[str, float]:
    found = (json.loads(path.read_text()) for path in out.glob(f"students/*/{ID}.json"))
    return {one["entry"]["student"]: one["report"]["score"] for one in found}


def test_a_class_is_graded_exported_resumed_and_graded_again(mine: Path, handed_in: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    looked = run(mine, handed_in, "--dry-run")
    assert "ben/work.py" in looked.stdout, looked.stderr
    starters = [row for row in rows(out / "intake.csv") if "starter" in row["look at it"]]
    assert [row["student"] for row in starters] == ["cem"]

    done = run(mine, handed_in)
    assert done.returncode == 0, done.stderr
    assert scores(out) == {"ann": 3.0, "ben": 1.0, "cem": 1.0}
    page = (out / "index.html").read_text()
    assert "A service that adds three numbers" in page
    assert "It adds" in page
    grades = rows(out / "grades.csv")
    assert {row["student"] for row in grades} == {"ann", "ben", "cem"}
    assert any(ID in name for name in grades[0])
    for export in ("canvas.csv", "nbgrader.csv", f"gradescope/ann/{ID}/results.json"):
        text = (out / "exports" / export).read_text()
        assert ID in text or "A service that adds three numbers" in text, export

    (handed_in / "ben/work.py").write_text(SOLUTION)
    done = run(mine, handed_in, "--resume")
    assert done.returncode == 0, done.stderr
    assert scores(out) == {"ann": 3.0, "ben": 3.0, "cem": 1.0}

    checks = mine / "checks.py"
    checks.write_text(checks.read_text().replace("points=1.0", "points=1.5").replace("points=2.0", "points=1.5"))
    again = run(mine, handed_in, "--resume", "--again", ID, "--write")
    assert again.returncode == 0, again.stderr
    assert scores(out) == {"ann": 3.0, "ben": 3.0, "cem": 1.5}
    (mine / "samples.py").write_text("SAMPLES = [(1, 2, 0)]\n")  # beside the checks, and a part of the grader
    assert f"Graded by another version of the kit or the exercise than today's: 3 of {ID}" in (
        run(mine, handed_in, "--resume").stderr
    )
    hidden = course_kit("export", "anonymous", out, "--to", tmp_path / "hidden")
    assert hidden.returncode == 0, hidden.stderr

    mine.rename(tmp_path / "moved")
    gone = course_kit(
        "class", handed_in, "--out", out, "--exercise", OF_COURSE, "--resume"
    )  # the run has noted where it was
    assert gone.returncode == 2
    assert f"The exercise {ID} was in {mine}" in gone.stderr
    assert "Traceback" not in gone.stderr

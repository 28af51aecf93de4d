"""`course-kit regrade`: who changes from what to what is shown before anything is written; nothing is lost by it."""

from __future__ import annotations

import csv
import io
import json
import os
import shutil
import subprocess
from typing import TYPE_CHECKING

import pytest

from course_kit.cli.main import main, spelled_out
from tests.course_copy import REPOSITORY, copy_course

if TYPE_CHECKING:
    from pathlib import Path

    from tests.course_copy import Course

RIGHT = (REPOSITORY / "solutions/pattern_choice/pattern_choice.py").read_text()
EXERCISE = "pattern_choice"
GRADER = "course_kit/graders/pattern_choice.py"
MARK = "    def pattern(self, place: int, context: CheckContext) -> Evidence:\n"
pytestmark = [pytest.mark.answers, pytest.mark.timeout(240)]


@pytest.fixture
def course(tmp_path: Path) -> Course:
    """A copy of the course, in which a fault can be made."""
    return copy_course(tmp_path)


@pytest.fixture
def inbox(tmp_path: Path) -> Path:
    texts = {"ada": RIGHT, "bob": RIGHT.replace('"service"', '"topic"'), "cem": f"{RIGHT}\n# mine\n", "dee": ""}
    for student, text in texts.items():
        (tmp_path / "in" / student).mkdir(parents=True)
        (tmp_path / "in" / student / f"{EXERCISE}.py").write_text(text)
    return tmp_path / "in"


def break_grader(course: Course) -> None:
    """A fault that takes half a point from everybody: nobody's first pattern is right."""
    path = course.root / GRADER
    text = path.read_text()
    assert MARK in text
    fault = 'if place == 0:\n            raise Failed(Evidence("", "", ""), "A fault of the grader.", "quiz.malformed")'
    path.write_text(text.replace(MARK, f"{MARK}        {fault}\n"))


def mend_grader(course: Course) -> None:
    shutil.copy(REPOSITORY / GRADER, course.root / GRADER)


def table(out: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO((out / "regrade.csv").read_text(encoding="utf-8-sig"))))


def scores(out: Path) -> dict[str, float]:
    records = [json.loads(path.read_text()) for path in out.glob("students/*/*.json")]
    return {one["entry"]["student"]: one["report"]["score"] for one in records}


def class_run(course: Course, inbox: Path, out: Path, *more: str) -> str:
    done = course.run("class", str(inbox), "--exercise", EXERCISE, "--out", str(out), "--workers", "2", *more)
    assert done.returncode == 0, done.stderr
    return done.stderr


def test_a_mended_grader_changes_what_the_table_says_and_no_more(course: Course, inbox: Path, tmp_path: Path) -> None:
    out, clean = tmp_path / "out", tmp_path / "clean"
    break_grader(course)
    class_run(course, inbox, out)
    faulty = scores(out)
    assert faulty["ada"] == faulty["cem"] == 9.5
    (out / "overrides.csv").write_text(f"student,exercise,score,comment\ncem,{EXERCISE},6,Talked it over\n")
    mend_grader(course)
    said = class_run(course, inbox, out, "--resume")
    assert f"Graded by another version of the kit, the exercise or its grader than today's: 4 of {EXERCISE}" in said
    assert scores(out) == faulty, "that is for regrade"

    looked = course.run("class", "regrade", str(out))
    assert looked.returncode == 0, looked.stderr
    assert "Nothing was written" in looked.stderr
    assert scores(out) == faulty
    rows = {row["student"]: row for row in table(out)}
    assert set(rows) == {"ada", "bob", "cem"}, "dee handed in an empty file, whatever the grader"
    assert (rows["ada"]["was"], rows["ada"]["is"]) == ("9.5 (passed)", "10 (passed)")
    assert (rows["cem"]["was"], rows["cem"]["is"]) == ("6 (not passed)", "6 (not passed)"), "the override stays"
    assert rows["ada"]["checks that changed"].endswith("_pattern: failed -> passed")
    assert "set this score to 6 points; the checks gave 10" in rows["cem"]["remarks"]
    for row in rows.values():
        line = next(line for line in looked.stdout.splitlines() if line.startswith(row["student"]))
        assert row["was"] in line
        assert row["checks that changed"] in line

    written = course.run("regrade", str(out), "--write")
    assert written.returncode == 0, written.stderr
    class_run(course, inbox, clean)
    assert scores(out) == scores(clean)
    assert scores(out)["ada"] == 10.0
    kept = json.loads((out / f"superseded/ada/{EXERCISE}.1.json").read_text())
    assert kept["report"]["score"] == 9.5
    assert not (out / "superseded/dee").exists()
    assert not (out / "regrade").exists()
    assert "10 of 10 points" in (out / f"students/ada/{EXERCISE}.html").read_text(encoding="utf-8")
    grades = (out / "grades.csv").read_text(encoding="utf-8-sig")
    assert "ada,,10,10,passed" in grades
    assert "cem,,6,10,not passed" in grades
    assert "another version" not in class_run(course, inbox, out, "--resume")


def test_only_what_was_named_is_graded_again(course: Course, inbox: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    break_grader(course)
    class_run(course, inbox, out)
    faulty = scores(out)
    mend_grader(course)
    done = course.run("regrade", str(out), "--student", "ada", "--exercise", EXERCISE, "--write")
    assert done.returncode == 0, done.stderr
    assert scores(out) == {**faulty, "ada": 10.0}
    check = next(row["checks that changed"].partition(":")[0] for row in table(out))
    done = course.run("regrade", str(out), "--check", check, "--write")
    assert "3 submissions" in done.stderr, "of an empty file no check was run"
    assert scores(out) == {**faulty, "ada": 10.0, "bob": faulty["bob"] + 0.5, "cem": 10.0}
    for option, name, meant in (("--student", "ad", "ada"), ("--check", f"{check}s", check), ("--exercise", "x", "")):
        done = course.run("regrade", str(out), option, name)
        assert done.returncode == 2
        assert f"Among these results there is no {option[2:]} '{name}' here." in done.stderr
        assert (f"Did you mean {meant}?" in done.stderr) == bool(meant)


def test_what_was_handed_in_anew_meanwhile_keeps_its_result_and_is_named(
    course: Course, inbox: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    break_grader(course)
    class_run(course, inbox, out)
    mend_grader(course)
    (inbox / f"ada/{EXERCISE}.py").write_text("answers = {}")
    done = course.run("regrade", str(out), "--write")
    assert done.returncode == 2
    assert f"1 submission changed after the grading, or cannot be read: ada, {EXERCISE}." in done.stderr
    assert (scores(out)["ada"], scores(out)["cem"]) == (9.5, 10.0)


@pytest.mark.parametrize(("answer", "score"), [("y", 10.0), ("n", 9.5)])
def test_at_a_terminal_it_asks(answer: str, score: float, course: Course, inbox: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    break_grader(course)
    class_run(course, inbox, out)
    mend_grader(course)
    ours, theirs = os.openpty()
    try:
        os.write(ours, f"{answer}\n".encode())
        done = subprocess.run(
            course.command("regrade", str(out), "--student", "ada"),
            cwd=course.root,
            env=course.environ(),
            stdin=theirs,
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )
    finally:
        os.close(ours)
        os.close(theirs)
    assert done.returncode == 0, done.stderr
    assert "Write 1 result? [y/N]" in done.stderr
    assert scores(out)["ada"] == score


def test_a_folder_without_results_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["regrade", str(tmp_path)]) == 2
    assert "does not hold the results of a class run" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_submissions_in_a_folder_called_regrade_are_still_a_class() -> None:
    assert spelled_out(["class", "regrade", "out"]) == ["regrade", "out"]
    run = ["class", "regrade", "--exercise", EXERCISE, "--out", "out"]
    assert spelled_out(run) == run

"""`class --resume --again EXERCISE`: who changes is shown before anything is written; nothing is lost."""

from __future__ import annotations

import csv
import io
import json
import os
import shutil
import subprocess
from typing import TYPE_CHECKING

import pytest

from course_kit.cli.main import main
from tests.course_copy import REPOSITORY, copy_course

if TYPE_CHECKING:
    from pathlib import Path

    from tests.course_copy import Course

RIGHT = (REPOSITORY / "solutions/pattern_choice/pattern_choice.py").read_text()
EXERCISE = "pattern_choice"
GRADER = "course_kit/graders/pattern_choice.py"
MARK = "    def mark(self, place: int, half: str, context: CheckContext) -> Evidence:\n"
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
    fault = 'raise Failed(Evidence("", "", ""), "A fault of the grader.", "quiz.malformed")'
    fault = f'if (place, half) == (0, "pattern"):\n            {fault}'
    path.write_text(text.replace(MARK, f"{MARK}        {fault}\n"))


def mend_grader(course: Course) -> None:
    shutil.copy(REPOSITORY / GRADER, course.root / GRADER)


def table(out: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO((out / "regrade.csv").read_text(encoding="utf-8-sig"))))


def scores(out: Path) -> dict[str, float]:
    records = [json.loads(path.read_text()) for path in out.glob("students/*/*.json")]
    return {one["entry"]["student"]: one["report"]["score"] for one in records}


def class_run(course: Course, inbox: Path, out: Path, *more: str) -> str:
    done = course.run(*command(inbox, out, *more))
    assert done.returncode == 0, done.stderr
    return done.stderr


def command(inbox: Path, out: Path, *more: str) -> list[str]:
    return ["class", str(inbox), "--exercise", EXERCISE, "--out", str(out), "--workers", "2", *more]


def again(inbox: Path, out: Path, *more: str) -> list[str]:
    return command(inbox, out, "--resume", "--again", EXERCISE, *more)


def test_a_mended_grader_changes_what_the_table_says_and_no_more(course: Course, inbox: Path, tmp_path: Path) -> None:
    out, clean = tmp_path / "out", tmp_path / "clean"
    break_grader(course)
    class_run(course, inbox, out)
    faulty = scores(out)
    assert faulty["ada"] == faulty["cem"] == 9.5
    (out / "overrides.csv").write_text(f"student,exercise,score,comment\ncem,{EXERCISE},6,Talked it over\n")
    mend_grader(course)
    said = class_run(course, inbox, out, "--resume")
    assert f"Graded by another version of the kit or the exercise than today's: 4 of {EXERCISE}" in said
    assert scores(out) == faulty, "that is for --again"

    looked = course.run(*again(inbox, out))
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

    written = course.run(*again(inbox, out, "--write"))
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


def test_at_a_terminal_it_asks(course: Course, inbox: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    break_grader(course)
    class_run(course, inbox, out)
    mend_grader(course)
    ours, theirs = os.openpty()
    try:
        os.write(ours, b"y\n")
        done = subprocess.run(
            course.command(*again(inbox, out)),
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
    assert "Write 3 results? [y/N]" in done.stderr
    assert scores(out)["ada"] == 10.0


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--again", EXERCISE), "Add --resume"),
        (("--resume", "--again", "move_robot"), "--exercise does not"),
        (("--resume", "--write"), "with --again, too"),
    ],
)
def test_what_cannot_be_graded_again_is_said(
    more: tuple[str, ...], said: str, inbox: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(command(inbox, tmp_path / "out", *more)) == 2
    assert said in capsys.readouterr().err


def test_an_exercise_is_added_without_what_was_handed_in_for_the_others(inbox: Path, tmp_path: Path) -> None:
    """Week 3 after week 1: both exercises are in every table, and an earlier grade is not touched."""
    later, out = tmp_path / "week3", tmp_path / "out"
    for student in ("ada", "eve"):
        (later / student).mkdir(parents=True)
        (later / student / "temperature_service.py").write_text("def broken(:\n")
    assert main([*command(inbox, out)]) == 0
    before = scores(out)
    week3 = ["class", str(later), "--exercise", "temperature_service", "--out", str(out), "--resume"]
    assert main(week3) == 0
    rows = {row["student"]: row for row in csv.DictReader(io.StringIO((out / "grades.csv").read_text("utf-8-sig")))}
    assert rows["ada"][f"{EXERCISE} status"] == "passed"
    assert rows["ada"]["temperature_service status"] == "crashed"
    assert rows["bob"]["temperature_service status"] == rows["eve"][f"{EXERCISE} status"] == "missing"
    kept = {path.parent.name for path in out.glob(f"students/*/{EXERCISE}.json")}
    assert kept == set(before)
    assert main([*command(inbox, out, "--resume")]) == 0
    assert (out / "grades.csv").read_text("utf-8-sig").count("crashed") == 2

"""`course-kit class --dry-run`: the table of what would be graded, and nothing is."""

from __future__ import annotations

import csv
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit import environment

from .accidents import SERVICE, STARTER, notebook, program, zipped

if TYPE_CHECKING:
    from pathlib import Path

PATIENCE_S = 240


@pytest.fixture
def handed_in(tmp_path: Path) -> Path:
    """Ann has solved one of two files, bob handed in a zip, cem the starter, and dee something else."""
    files = {
        f"ann/{SERVICE.starter}": STARTER,
        f"ann/{SERVICE.notebook}": notebook(1),
        "bob/work.zip": zipped({f"hw/{SERVICE.starter}": program(2)}),
        f"cem/{SERVICE.starter}": STARTER,
        "dee/essay.txt": b"",
        "dee/more.txt": b"",
    }
    for name, content in files.items():
        path = tmp_path / "in" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return tmp_path / "in"


def dry_run(*arguments: object) -> subprocess.CompletedProcess[str]:
    out = arguments[0].parent / "out"  # type: ignore[attr-defined]
    command = ["-m", "course_kit", "class", *arguments, "--exercise", SERVICE.id, "--out", out, "--dry-run"]
    return subprocess.run(
        [sys.executable, *map(str, command)],
        env=environment.child_environment(),
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )


def test_it_shows_what_would_be_graded_and_grades_nothing(handed_in: Path) -> None:
    (handed_in.parent / "list.csv").write_text("login,name\nann,Ann A\nbob,Bob B\ncem,Cem C\ndee,Dee D\nned,Ned N\n")
    before = sorted(handed_in.rglob("*"))
    done = dry_run(handed_in, "--roster", handed_in.parent / "list.csv")
    assert done.returncode == 2, done.stderr
    assert "Traceback" not in done.stderr
    lines = done.stdout.splitlines()
    assert lines[0].split() == ["student", "exercise", "file", "why", "also", "handed", "in"]
    assert [line.split("  ")[0] for line in lines[1:6]] == [
        "ann (Ann A)",
        "bob (Bob B)",
        "cem (Cem C)",
        "dee (Dee D)",
        "ned (Ned N)",
    ]
    assert f"ann/{SERVICE.notebook} " in lines[1]
    assert "the only one of 2 files that differs from the starter;" in lines[1]
    assert (
        "Check these choices of file (see intake.csv): cem Cem C, temperature_service (it is the starter, unchanged)."
        in done.stderr
    )
    assert (
        "list.csv: 'login' is the login, 'name' is the full name. 4 of its 5 students handed something in."
        in done.stderr
    )
    assert "Not handed in: Ned N." in done.stderr
    assert "1 student handed in something that was not graded: dee Dee D (none of it belongs to these" in done.stderr
    assert sorted(handed_in.rglob("*")) == before
    assert [path.name for path in (handed_in.parent / "out").iterdir()] == ["intake.csv"]
    with (handed_in.parent / "out/intake.csv").open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["student"], row["file"], row["look at it"]) for row in rows if row["student"]] == [
        ("ann", f"ann/{SERVICE.notebook}", ""),
        ("bob", f"bob/work.zip.contents/hw/{SERVICE.starter}", ""),
        ("cem", f"cem/{SERVICE.starter}", "it is the starter, unchanged"),
        ("dee", "", "not graded"),
        ("ned", "", ""),
    ]
    assert rows[0]["also handed in"] == f"ann/{SERVICE.starter} (the starter, unchanged)"
    assert {row["file"] for row in rows if not row["student"]} == {
        f"ann/{SERVICE.starter}",
        "dee/essay.txt",
        "dee/more.txt",
    }


def test_an_exercise_that_no_assignment_of_canvas_is_called_like_is_said(tmp_path: Path) -> None:
    (tmp_path / "in/ann").mkdir(parents=True)
    (tmp_path / "in/ann" / SERVICE.starter).write_bytes(program(1))
    for title, is_said in (("Homework 3", True), ("Week 3: Temperature service", False)):
        listed = f"Student,ID,SIS User ID,SIS Login ID,Section,{title} (811)\nAnn A,7,,ann,A,\n"
        (tmp_path / "gradebook.csv").write_text(listed)
        done = dry_run(tmp_path / "in", "--roster", tmp_path / "gradebook.csv")
        said = f"gradebook.csv has no assignment for {SERVICE.id}, or more than one"
        assert (said in done.stderr) == is_said, done.stderr

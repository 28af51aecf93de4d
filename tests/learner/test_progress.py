"""The file of a learner's progress: nothing is lost, and nothing about it stops a grading."""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from dataclasses import replace
from typing import TYPE_CHECKING, NoReturn

import pytest

from course_kit.grading import CheckReport, Report
from course_kit.grading.model.exercise import list_exercise_ids
from course_kit.learner import progress
from tests.course_copy import SOLUTION, TEMPERATURE, copy_course

if TYPE_CHECKING:
    from pathlib import Path

MANY_TRIES = """
from msgspec.structs import replace
from course_kit.learner import progress
for _ in range(25):
    assert progress.update_progress("exercise", lambda old: replace(old, tries=old.tries + 1)) == ""
"""


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "progress.json"
    monkeypatch.setenv(progress.VARIABLE, str(path))
    return path


def a_report(score: float, status: str = "graded", *checks: CheckReport) -> Report:
    return Report("exercise", "Title", "file.py", status, score >= 7, score, 10.0, 1.0, checks)


def a_check(name: str, status: str, diagnosis: str | None = None) -> CheckReport:
    return CheckReport(name, name.title(), status, 1.0, diagnosis=diagnosis)


def test_the_best_score_and_the_first_pass_stay_and_the_failure_is_the_last_gradings(file: Path) -> None:
    failing = (a_check("first", "passed"), a_check("second", "failed", "code"), a_check("third", "failed"))
    assert progress.record_report(a_report(3.0, "graded", *failing)) == ""
    early = progress.read_progress()[0]["exercise"]
    assert (early.best, early.tries, early.passed) == (3.0, 1, False)
    assert early.failed == progress.Failure("second", "Second", "code")
    progress.record_report(a_report(8.0))
    passed = progress.read_progress()[0]["exercise"]
    assert (passed.best, passed.tries, passed.passed, passed.failed) == (8.0, 2, True, None)
    progress.record_report(a_report(2.0, "crashed", *failing))
    late = progress.read_progress()[0]["exercise"]
    assert (late.best, late.tries, late.passed, late.first_passed) == (8.0, 3, True, passed.first_passed)
    assert late.failed == early.failed
    assert sorted(path.name for path in file.parent.iterdir()) == ["progress.json", "progress.lock"]


def test_off_keeps_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(progress.VARIABLE, "off")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert progress.record_report(a_report(8.0)) == ""
    assert progress.read_progress() == ({}, "")
    assert list(tmp_path.iterdir()) == []


def test_it_belongs_to_the_course_and_not_to_the_user(tmp_path: Path) -> None:
    """Who passed everything in one clone has passed nothing in a fresh one."""
    first, fresh = copy_course(tmp_path / "first"), copy_course(tmp_path / "fresh")
    mine = {"COURSE_KIT_PROGRESS": "", "XDG_STATE_HOME": str(tmp_path)}
    first.run("grade", TEMPERATURE, str(SOLUTION), **mine)
    exercises = len(list_exercise_ids(first.root / "exercises"))
    assert f"1 of {exercises} passed" in first.run("list", **mine).stdout
    assert f"0 of {exercises} passed" in fresh.run("list", **mine).stdout
    assert (first.root / ".course" / "progress.json").is_file()


def test_graders_at_the_same_time_lose_nothing(file: Path) -> None:
    graders = [subprocess.Popen([sys.executable, "-c", MANY_TRIES]) for _ in range(4)]
    assert [grader.wait(60) for grader in graders] == [0, 0, 0, 0]
    assert json.loads(file.read_text())["exercises"]["exercise"]["tries"] == 100


def test_forgetting_one_exercise_keeps_the_others(file: Path) -> None:
    progress.record_report(a_report(8.0))
    progress.record_report(replace(a_report(5.0), exercise="other"))
    assert progress.update_progress("exercise", lambda _: None) == ""
    assert list(progress.read_progress()[0]) == ["other"]
    assert file.exists()


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        '{"format_version": 1, "exercises": {"exercise": {"tries": "3"}}}',
        '{"format_version": 1, "exercises": {"exercise": {"best": NaN}}}',
        '{"format_version": 1, "exercises": {"exercise": {"unknown": 1}}}',
        "[" * 100_000,
        "\udcff",
    ],
)
def test_a_damaged_file_is_left_alone_and_how_to_go_on_is_said(file: Path, text: str) -> None:
    content = text.encode(errors="surrogateescape")
    file.write_bytes(content)
    assert "is damaged. Rename it, and the course starts a new one. Nothing was recorded." in progress.record_report(
        a_report(8.0)
    )
    records, told = progress.read_progress()
    assert (records, "is damaged" in told) == ({}, True)
    assert file.read_bytes() == content


def test_a_full_disk_leaves_the_old_file(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(descriptor: int) -> NoReturn:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(descriptor))

    progress.record_report(a_report(3.0))
    monkeypatch.setattr(os, "fsync", full)
    assert "No space left" in progress.record_report(a_report(8.0))
    assert progress.read_progress()[0]["exercise"].best == 3.0
    assert sorted(path.name for path in file.parent.iterdir()) == ["progress.json", "progress.lock"]

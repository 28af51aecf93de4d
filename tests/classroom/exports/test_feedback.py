"""Feedback goes back to the student it is for, by each platform's own way to read a zip's names."""

from __future__ import annotations

import re
import zipfile
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom import exports
from course_kit.classroom.exports.report_page import render_page
from course_kit.classroom.records import GradeRecord, RecordFolder
from course_kit.grading.model.report import Report
from tests.classroom.exports.books import HOSTILE, ROBOT, SERVICE, bad, book, good, not_graded, unreadable

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.records import Gradebook

REPORT = Report(SERVICE.id, SERVICE.title, "answer.py", "graded", True, 10, 10, 1.0)


def written(gradebook: Gradebook, out: Path) -> Path:
    for record in gradebook.records:
        RecordFolder(out).keep(record, render_page(REPORT, record.entry.student))
    exports.write_all(gradebook, out)
    return out


def contents(path: Path) -> dict[str, str]:
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        return {name: archive.read(name).decode() for name in archive.namelist()}


def read_by_moodle(path: str) -> tuple[int, str, str]:
    """Participant, plugin and file; rests on Moodle's mod/assign/feedback/file/importziplib.php."""
    parts = path.split("/")
    assert not parts[-1].startswith((".", "~"))
    while parts:
        pieces = parts.pop(0).split("_", 4)
        if len(pieces) >= 4 and pieces[1].isdigit():
            rest = [*pieces[4:], *parts] if len(pieces) == 5 else ["", *parts]
            return int(pieces[1]), f"{pieces[2]}_{pieces[3]}", "/".join(rest).lstrip("/")
    raise AssertionError(path)


def read_by_canvas(path: str) -> tuple[str, str]:
    """User and attachment; rests on Canvas's AbstractAssignment#infer_comment_context_from_filename."""
    pieces = [one for one in path.rpartition("/")[2].split("_") if one != "LATE"]
    assert not pieces[-1].startswith("link")
    user, attachment = [one for one in pieces if re.fullmatch(r"[0-9]+", one)][:2]
    return user, attachment


def of_moodle(number: int, name: str, maker: object = good, **more: object) -> GradeRecord:
    source = f"{name}_{number}_assignsubmission_file/temperature_service.py"
    platform = {"moodle_participant": str(number)}
    return maker(str(number), name=name, source=source, platform=platform, **more)  # type: ignore[operator,no-any-return]


def of_canvas(user: int, file: str, maker: object = good) -> GradeRecord:
    platform = {"canvas_user": str(user), "canvas_submission": str(1000 + user)}
    source = f"doejane_LATE_{user}_{1000 + user}_{file}"
    return maker(str(user), source=source, platform=platform)  # type: ignore[operator,no-any-return]


def test_moodle_finds_each_participant_and_nobody_without_a_grade_is_in_it(tmp_path: Path) -> None:
    class_ = [of_moodle(4711, "Jane Doe"), of_moodle(4712, "Jane Doe", bad), of_moodle(4713, "Li", not_graded)]
    gradebook = book(*class_, of_moodle(4711, "Jane Doe", of=ROBOT), exercises=(SERVICE, ROBOT))
    out = written(gradebook, tmp_path)
    files = contents(out / "exports/moodle_feedback_temperature_service.zip")
    report = "report_temperature_service.html"
    found = [read_by_moodle(name) for name in files]
    assert found == [(number, "assignsubmission_file", report) for number in (4711, 4712)]
    assert all("<!DOCTYPE html>" in text for text in files.values())
    assert list(contents(out / "exports/moodle_feedback_move_robot.zip")) == [
        "Jane Doe_4711_assignsubmission_file/report_move_robot.html"
    ]


def test_moodle_finds_everybody_whatever_they_are_called(tmp_path: Path) -> None:
    names = [*HOSTILE, "Jane_7_Doe_8", "../../etc/passwd", "C:\\x", "."]
    out = written(book(*(of_moodle(100 + place, name) for place, name in enumerate(names))), tmp_path)
    files = contents(out / "exports/moodle_feedback_temperature_service.zip")
    assert sorted(read_by_moodle(name)[0] for name in files) == [100 + place for place in range(len(names))]
    for name in files:
        assert name.count("/") == 1
        assert not name.startswith(("/", "."))
        assert "\\" not in name


def test_canvas_finds_student_and_attachment_by_the_names_of_its_download(tmp_path: Path) -> None:
    class_ = [of_canvas(7, "answer.py"), of_canvas(8, "answer-2.ipynb", bad), of_canvas(9, "1_2_3.py", unreadable)]
    class_.append(of_canvas(91, "all.zip.contents/mine"))
    with zipfile.ZipFile(written(book(*class_), tmp_path) / "exports/canvas_feedback_temperature_service.zip") as files:
        names = files.namelist()
        with files.open(names[-1]) as packed, zipfile.ZipFile(packed) as inner:
            assert inner.namelist() == ["report.txt"]
    assert {read_by_canvas(name) for name in names} == {(str(user), str(1000 + user)) for user in (7, 8, 9, 91)}
    assert names == [record.entry.source.partition(".contents")[0] for record in class_]


@pytest.mark.parametrize("kind", ["moodle", "canvas"])
def test_nobody_of_the_platform_no_zip_and_none_of_before_stays(tmp_path: Path, kind: str) -> None:
    path = tmp_path / f"exports/{kind}_feedback_temperature_service.zip"
    written(book(of_moodle(4711, "Jane"), of_canvas(7, "answer.py")), tmp_path)
    assert path.is_file()
    written(book(good("jane")), tmp_path)
    assert not path.exists()

"""Every format is read back by its platform's rules, and every name survives it."""

from __future__ import annotations

import string
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom import exports
from course_kit.classroom.intake import roster
from tests.classroom.exports import books, rules
from tests.classroom.exports.books import ROBOT, SERVICE, bad, book, good, not_graded, unreadable

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.records import Gradebook

EMPTY = book()
ONE = book(good("jane"))
HOSTILE_BOOK = books.hostile_book()


def written(gradebook: Gradebook) -> dict[str, str]:
    return dict(exports.export_files(gradebook))


def table(text: str) -> list[dict[str, str]]:
    header, *rows = rules.rows_of(text.removeprefix("\ufeff"))
    return [dict(zip(header, row, strict=True)) for row in rows]


@pytest.mark.parametrize("gradebook", [EMPTY, ONE, HOSTILE_BOOK], ids=["empty", "one", "hostile"])
def test_every_file_follows_its_platforms_rules(gradebook: Gradebook) -> None:
    files = written(gradebook)
    rules.canvas(files["exports/canvas.csv"])
    for name, text in files.items():
        text.encode()
        if name.endswith("results.json"):
            rules.gradescope(text)


@pytest.mark.parametrize(
    ("name", "matched"), [("grades.csv", set()), ("exports/canvas.csv", {1, 3}), ("exports/nbgrader.csv", {3})]
)
def test_no_cell_of_a_table_begins_a_formula_that_does_anything(name: str, matched: set[int]) -> None:
    """But where a platform finds students by it: a sign before what can call nothing, such as -jane, stays there."""
    for row in rules.rows_of(written(HOSTILE_BOOK)[name]):
        for column, cell in enumerate(row):
            if cell.startswith(("=", "+", "-", "@", "\t", "\r")):
                assert column in matched
                assert set(cell) <= set(string.ascii_letters + string.digits + "_.@+-"), cell


def test_grades_land_in_the_assignment_of_canvas_that_is_called_like_the_exercise(tmp_path: Path) -> None:
    """The gradebook that Canvas exports is the roster: its titles and SIS ids come back."""
    listed = tmp_path / "gradebook.csv"
    listed.write_text(
        "Student,ID,SIS User ID,SIS Login ID,Section,Week 1: temperature service (811),Essay (812),Essay Final Score\n"
        "    Points Possible,,,,,10,5,\n"
        '"Doe, Jane",4711,S-1,jane,A,,,\n'
    )
    found = roster.read_roster(listed)
    assert found.canvas_assignments == ("Week 1: temperature service (811)", "Essay (812)")
    jane = good("jane", platform=found.people[0].platform)
    one = replace(
        book(jane, good("li"), bad("jane", of=ROBOT), exercises=(SERVICE, ROBOT)),
        canvas_assignments=found.canvas_assignments,
    )
    points, rows = rules.canvas(written(one)["exports/canvas.csv"])
    assert list(points) == ["Week 1: temperature service (811)", ROBOT.title]
    assert [rows[0][name] for name in ("ID", "SIS User ID", "SIS Login ID")] == ["4711", "S-1", "jane"]
    assert [rows[1][name] for name in ("ID", "SIS User ID", "SIS Login ID")] == ["", "", "li"]


def test_where_the_grader_failed_there_is_no_grade_in_any_export(tmp_path: Path) -> None:
    of_moodle = {"platform": {"moodle_participant": "7"}}
    exports.write_all(book(good("jane", **of_moodle)), tmp_path)
    graded = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert "exports/moodle_temperature_service.csv" in graded
    exports.write_all(book(not_graded("jane", **of_moodle)), tmp_path)  # the grade of before must not stay either
    left = {path.relative_to(tmp_path).as_posix(): path.read_text() for path in tmp_path.rglob("*") if path.is_file()}
    assert set(left) == {"grades.csv", "exports/canvas.csv", "exports/nbgrader.csv", "index.html", "last_run.json"}
    assert not any("jane" in left[name] for name in left if name.startswith("exports/"))
    assert table(left["grades.csv"])[0]["temperature_service status"] == "error"


def test_grades_has_a_row_for_each_student() -> None:
    gradebook = book(
        good("jane", name="Jane Doe", late=True),
        bad("jane", of=ROBOT),
        unreadable("jörg"),
        not_graded("li"),
        exercises=(SERVICE, ROBOT),
        missing=(("jörg", ROBOT.id), ("li", ROBOT.id)),
    )
    text = written(gradebook)["grades.csv"]
    assert text.startswith("\ufeff"), "Excel takes it for another encoding"
    jane, joerg, li = table(text)
    assert jane == {
        "student": "jane",
        "name": "Jane Doe",
        "temperature_service score": "10",
        "temperature_service max": "10",
        "temperature_service status": "passed",
        "temperature_service late": "late",
        "temperature_service checks": "10",
        "temperature_service remarks": "",
        "move_robot score": "0",
        "move_robot max": "20",
        "move_robot status": "not passed",
        "move_robot late": "",
        "move_robot checks": "0",
        "move_robot remarks": "",
        "total": "10",
        "total max": "30",
    }
    assert (joerg["temperature_service score"], joerg["temperature_service status"]) == ("0", "unreadable")
    assert (joerg["move_robot score"], joerg["move_robot status"]) == ("", "missing")
    assert (li["temperature_service score"], li["temperature_service status"]) == ("", "error"), "that is no zero"


def test_canvas_finds_students_by_its_own_number_else_by_login() -> None:
    of_canvas = book(good("12345", name="doejane", platform={"canvas_user": "12345"}), bad("7"), layout="canvas")
    points, students = rules.canvas(written(of_canvas)["exports/canvas.csv"])
    assert points == {SERVICE.title: 10.0}
    assert [(one["Student"], one["ID"], one[SERVICE.title]) for one in students] == [
        ("doejane", "12345", "10"),
        ("7", "7", "0"),
    ]
    _, students = rules.canvas(written(book(good("jane"), not_graded("jörg")))["exports/canvas.csv"])
    assert [(one["ID"], one["SIS Login ID"], one[SERVICE.title]) for one in students] == [("", "jane", "10")]


def test_moodle_gets_a_worksheet_for_each_exercise() -> None:
    gradebook = book(
        good("4711", name="Jane Doe", platform={"moodle_participant": "4711"}),
        bad("4712", name="Jörg, jr.", platform={"moodle_participant": "4712"}),
        not_graded("4713", platform={"moodle_participant": "4713"}),
        bad("4711", of=ROBOT, platform={"moodle_participant": "4711"}),
        exercises=(SERVICE, ROBOT),
    )
    files = written(gradebook)
    rows = rules.moodle(files["exports/moodle_temperature_service.csv"])
    assert list(rows) == [4711, 4712], "a row for the third would write over the comment that Moodle has"
    assert (rows[4711]["Grade"], rows[4711]["Maximum Grade"], rows[4711]["Full name"]) == ("10", "10", "Jane Doe")
    assert "The check first: first did not hold." in rows[4712]["Feedback comments"]
    assert list(rules.moodle(files["exports/moodle_move_robot.csv"])) == [4711]


def test_moodles_comments_are_html_in_which_nothing_runs() -> None:
    evil = bad("1", platform={"moodle_participant": "1"})
    evil.report["checks"][0]["message"] = "<script>alert(1)</script>\nnext line"
    comments = rules.moodle(written(book(evil))["exports/moodle_temperature_service.csv"])[1]["Feedback comments"]
    assert "<script>" not in comments
    assert "&lt;script&gt;alert(1)&lt;/script&gt;<br>next line" in comments


def test_gradescope_shows_each_check_with_its_evidence() -> None:
    result = rules.gradescope(written(book(bad("jane")))["exports/gradescope/jane/temperature_service/results.json"])
    assert result["score"] == 0
    first, second = result["tests"]
    assert (first["status"], first["score"], first["max_score"]) == ("failed", 0, 5)
    assert "service.no_return" in first["tags"]
    for line in ("We sent: 1 °C", "Expected: 33.8", "We got: 0", "first did not hold.", "Hint: Look <again>."):
        assert line in first["output"]
    assert second["output"]

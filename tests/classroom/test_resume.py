"""Running again: the inbox as it is now, the instructor's files, and nothing that was graded is lost."""

from __future__ import annotations

import json
import shutil
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any

import pytest

from course_kit.classroom import exports
from course_kit.classroom.records import GradeRecord
from course_kit.grading import GradingError
from tests.classroom.stand_ins import CHOICE, SERVICE, StandInForGrading, results, run

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.records import Gradebook

BERLIN = 'timezone = "Europe/Berlin"\n'
RULES = f"{BERLIN}grace_minutes = 10\npenalty_percent_per_day = 10\npenalty_at_most_percent = 50\n"
DUE = "[due]\ntemperature_service = 2026-11-20T23:59:00\n"  # 22:59 UTC


@pytest.fixture
def inbox(tmp_path: Path) -> Path:
    for student, text in {"ada": "right = 1", "bob": "wrong = 1", "cem": "right = 2"}.items():
        hand_in(tmp_path / "in", student, text)
    return tmp_path / "in"


def hand_in(inbox: Path, student: str, text: str, stamp: str = "") -> None:
    folder = inbox / student
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "temperature_service.py").write_text(text)
    if stamp:
        (folder / "timestamp.txt").write_text(stamp)


def as_nbgrader_collects(inbox: Path) -> None:
    """Put each student's files where nbgrader has them, its stamp included."""
    for folder in [*inbox.iterdir()]:
        target = inbox / "submitted" / folder.name / "week1"
        target.parent.mkdir(parents=True)
        folder.rename(target)


def again(inbox: Path, **options: Any) -> tuple[Gradebook, list[str]]:
    """Resume, write the exports; returns the gradebook and who was graded."""
    executor = StandInForGrading()
    out = inbox.parent / "out"
    book = run(inbox, out, executor, resume=True, **options)
    exports.write_all(book, out)
    return book, sorted(request.shown.partition("/")[0] for request in executor.requests)


def files(out: Path) -> set[str]:
    return {path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file()}


def test_what_is_gone_counts_nowhere_and_is_kept(inbox: Path) -> None:
    out = inbox.parent / "out"
    again(inbox)
    assert "exports/gradescope/bob/temperature_service/results.json" in files(out)
    record = (out / "students/bob/temperature_service.json").read_bytes()
    (inbox / "bob/temperature_service.py").unlink()
    (inbox / "bob").rmdir()
    book, graded = again(inbox)
    assert graded == []
    assert set(results(book)) == {"ada", "cem"}
    assert (out / "superseded/bob/temperature_service.1.json").read_bytes() == record
    assert (out / "superseded/bob/temperature_service.1.html").is_file()
    assert [name for name in files(out) if "bob" in name and not name.startswith("superseded/")] == []
    assert "bob" not in (out / "grades.csv").read_text(encoding="utf-8-sig")


def test_what_has_changed_is_graded_again_and_the_result_of_before_is_kept(inbox: Path) -> None:
    out = inbox.parent / "out"
    again(inbox)
    for number, text in enumerate(("right = 5", "wrong = 6"), start=1):
        hand_in(inbox, "bob", text)
        book, graded = again(inbox)
        assert graded == ["bob"]
        assert results(book)["bob"][1] == (10.0 if number == 1 else 0.0)
    kept = [GradeRecord.from_json((out / f"superseded/bob/temperature_service.{n}.json").read_text()) for n in (1, 2)]
    assert [record.score for record in kept] == [0.0, 10.0]


def test_what_is_the_same_in_another_place_is_kept_under_its_new_name(inbox: Path) -> None:
    again(inbox)
    (inbox / "bob/temperature_service.py").rename(inbox / "bob/my_temperature_service.py")
    book, graded = again(inbox)
    assert graded == []
    record = next(one for one in book.records if one.entry.student == "bob")
    assert record.entry.source == record.report["submission"] == "bob/my_temperature_service.py"


def settings(inbox: Path, **texts: str) -> Path:
    """Write the instructor's files: `class_toml`, `overrides`, `extensions`."""
    out = inbox.parent / "out"
    out.mkdir(exist_ok=True)
    for name, text in texts.items():
        (out / {"class_toml": "class.toml"}.get(name, f"{name}.csv")).write_text(text, encoding="utf-8")
    return out


def scores(book: Gradebook) -> dict[str, float]:
    return {record.entry.student: record.score for record in book.records}


def test_overrides_and_comments_survive_each_run_and_stand_in_report_and_grades(inbox: Path) -> None:
    out = settings(
        inbox, overrides="student,exercise,score,comment\nbob,temperature_service,7.5,Explained it <well>.\n"
    )
    for text in ("wrong = 1", "wrong = 2", "right = 3"):
        hand_in(inbox, "bob", text)
        book, _ = again(inbox)
        assert scores(book) == {"ada": 10.0, "bob": 7.5, "cem": 10.0}
        page = (out / "students/bob/temperature_service.html").read_text(encoding="utf-8")
        assert page.count("has set this score to 7.5 points") == 1
        assert "Explained it &lt;well&gt;." in page
        assert "Explained it <well>." in (out / "grades.csv").read_text(encoding="utf-8-sig")
    assert json.loads((out / "students/bob/temperature_service.json").read_text())["report"]["score"] == 10.0
    (out / "overrides.csv").unlink()
    book, graded = again(inbox)
    assert graded == []
    assert scores(book)["bob"] == 10.0
    assert "has set this score" not in (out / "students/bob/temperature_service.html").read_text(encoding="utf-8")


def test_a_score_with_a_plus_is_added_to_that_of_the_checks_up_to_full_marks(inbox: Path) -> None:
    hand_in(inbox, "bob", "wrong = 1")
    added = "student,exercise,score,comment\nbob,temperature_service,+1.5,Neat names.\nada,temperature_service,+1,\n"
    out = settings(inbox, overrides=added)
    book, _ = again(inbox)
    assert scores(book) == {"ada": 10.0, "bob": 1.5, "cem": 10.0}
    page = (out / "students/bob/temperature_service.html").read_text(encoding="utf-8")
    assert "Your instructor has added 1.5 points." in page
    assert "Neat names." in page
    assert "set this score" not in page


def test_who_handed_in_nothing_can_have_a_score(inbox: Path) -> None:
    (inbox / "bob/pattern_choice.py").write_text("answers = {}  # right")
    out = settings(inbox, overrides="student;exercise;score;comment\nada;pattern_choice;7,5;Oral exam\n")
    book, _ = again(inbox, exercises=(SERVICE, CHOICE))
    assert ("ada", CHOICE.id) not in book.missing
    assert ("cem", CHOICE.id) in book.missing
    assert "Oral exam" in (out / "students/ada/pattern_choice.html").read_text(encoding="utf-8")
    assert "ada,,10,10,passed,,10,,7.5,10,not passed" in (out / "grades.csv").read_text(encoding="utf-8-sig")
    (out / "overrides.csv").unlink()
    again(inbox, exercises=(SERVICE, CHOICE))
    assert not (out / "students/ada/pattern_choice.html").exists()


def test_a_mistake_in_the_overrides_is_told_with_its_line_before_anything_is_graded(inbox: Path) -> None:
    twice = 'student,exercise,comment\nbob,temperature_service,"two\nlines"\nbob,temperature_service,x\n'
    settings(inbox, overrides=twice)
    with pytest.raises(GradingError, match=r"overrides\.csv.*\n.*line 4: bob and temperature_service stand in line 2"):
        again(inbox)
    assert not (inbox.parent / "out/students").exists()


def test_lateness_comes_from_timestamps_and_costs_what_the_rules_say(inbox: Path) -> None:
    hand_in(inbox, "ada", "right = 1", "2026-11-20 23:08:59.123456 UTC")  # within the grace
    hand_in(inbox, "cem", "right = 2", "2026-11-20 23:09:01 UTC")  # after it: late since the due date, one day
    hand_in(inbox, "dan", "right = 3", "2026-11-21 23:59:01.0 CET")  # a second more than a day
    hand_in(inbox, "eva", "right = 4", "2026-12-20 12:00:00.0 Europe/Berlin")
    hand_in(inbox, "fay", "right = 5", "2026-11-20 20:00:00 -0800")  # 04:00 UTC on the next day
    as_nbgrader_collects(inbox)
    out = settings(inbox, class_toml=RULES + DUE)
    book, _ = again(inbox)
    assert scores(book) == {"ada": 10.0, "bob": 0.0, "cem": 9.0, "dan": 8.0, "eva": 5.0, "fay": 9.0}
    late = {record.entry.student for record in book.records if record.is_late}
    assert late == {"cem", "dan", "eva", "fay"}
    page = (out / "students/dan/temperature_service.html").read_text(encoding="utf-8")
    assert "What counts: 8 of 10 points" in page
    assert "Handed in 1 d late: on 2026-11-21 23:59 CET (UTC+01:00), due 2026-11-20 23:59 CET (UTC+01:00)." in page
    assert "Late penalty: 2 points" in page
    assert [one.entry.student for one in book.records if one.adjustment.warning] == ["bob"]


@pytest.mark.parametrize("packed", [True])
def test_a_timestamp_of_a_students_own_does_not_replace_nbgraders(packed: bool, tmp_path: Path) -> None:
    """It lies in a folder, or in a zip, that they have handed in; nbgrader's lies around it."""
    week = tmp_path / "submitted/ada/week1"
    hand_in(week, "mine", "right = 1", "2026-11-19 12:00:00.0 UTC")
    (week / "timestamp.txt").write_text("2026-11-22 12:00:00.0 UTC")
    if packed:
        shutil.make_archive(str(week / "mine"), "zip", week / "mine")
        shutil.rmtree(week / "mine")
    settings(tmp_path / "submitted", class_toml=RULES + DUE)
    book, _ = again(tmp_path / "submitted")
    assert scores(book) == {"ada": 8.0}


def test_a_rule_that_changes_needs_no_grading(inbox: Path) -> None:
    hand_in(inbox, "ada", "right = 1", "2026-11-21 12:00:00 UTC")
    as_nbgrader_collects(inbox)
    assert scores(again(inbox)[0])["ada"] == 10.0
    out = settings(inbox, class_toml=RULES + DUE)
    book, graded = again(inbox)
    assert (scores(book)["ada"], graded) == (9.0, [])
    settings(inbox, extensions="student,exercise,due\nada,,2026-11-21 13:00\n")
    assert scores(again(inbox)[0])["ada"] == 10.0
    settings(inbox, extensions="student,exercise,due\nada,temperature_service,2026-11-21 12:00\n")  # 11:00 UTC
    assert scores(again(inbox)[0])["ada"] == 9.0
    assert "your own date" in (out / "students/ada/temperature_service.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (DUE, "it is unclear which time zone 2026-11-20 23:59:00 is meant in"),
        (f"{BERLIN}{DUE}grace_minutes = 5\n", "'grace_minutes' stands below [due]"),
        (f"{BERLIN}[due]\ntemperature_service = 2026-11-20\n", "'2026-11-20' has no time of day"),
        ("[due\n", "at line 1"),
    ],
)
def test_a_mistake_in_the_rules_is_told_before_anything_is_graded(text: str, said: str, inbox: Path) -> None:
    settings(inbox, class_toml=text)
    with pytest.raises(GradingError) as told:
        again(inbox)
    assert said in str(told.value)
    assert "class.toml" in str(told.value)


@pytest.mark.parametrize(
    ("stamp", "hour", "said"),
    [
        ("2026-10-25 02:30:00 CET", 1, False),
        ("2026-10-25 02:30:00 Europe/Berlin", 0, True),
        ("2026-10-25 03:30:00 Europe/Berlin", 2, False),
    ],
)
def test_in_the_hour_that_comes_twice_the_offset_tells_or_the_earlier_counts_and_it_is_said(
    inbox: Path, stamp: str, hour: int, said: bool
) -> None:
    hand_in(inbox, "ada", "right = 1", stamp)
    as_nbgrader_collects(inbox)
    settings(inbox, class_toml=RULES + DUE)
    book, _ = again(inbox)
    found = book.records[0].adjustment
    assert found.submitted
    assert found.submitted.timestamp() == datetime(2026, 10, 25, hour, 30, tzinfo=timezone.utc).timestamp()
    assert ("twice" in found.warning) is said

"""A student stays the same student: over downloads, over runs, and in what the instructor has written about them."""

from __future__ import annotations

import zipfile
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom import exports
from course_kit.classroom.intake import roster
from course_kit.grading import GradingError
from tests.classroom.exports import rules
from tests.classroom.stand_ins import SERVICE, StandInForGrading, run

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.intake.roster import Roster
    from course_kit.classroom.records import Gradebook

WORKSHEET = (
    "Identifier,Full name,Email address\n"
    "Participant 11,Ann A,ann@x.example\nParticipant 12,Bob B,bob@x.example\nParticipant 13,Cem C,cem@x.example\n"
)
PARTICIPANTS = "First name,Last name,Email address\nAnn,A,ann@x.example\nBob,B,bob@x.example\nCem,C,cem@x.example\n"


def download(path: Path, **programs: str) -> Path:
    """A download of one assignment in Moodle; students are written Ann_A_11, an empty program makes an empty folder."""
    with zipfile.ZipFile(path, "w") as packed:
        for student, text in programs.items():
            first, last, number = student.split("_")
            folder = f"{first} {last}_{number}_assignsubmission_file/"
            packed.writestr(f"{folder}{SERVICE.starter if text else ''}", text)
    return path


def class_list(tmp_path: Path, text: str) -> Roster:
    (tmp_path / "list.csv").write_text(text)
    return roster.read_roster(tmp_path / "list.csv")


def scores(book: Gradebook) -> dict[str, float]:
    return {record.entry.student: record.score for record in book.records}


def worksheet(book: Gradebook) -> dict[int, dict[str, str]]:
    [text] = [text for name, text in exports.export_files(book) if name.startswith("exports/moodle")]
    return rules.moodle(text)


def test_a_later_download_of_the_assignment_beside_the_first_one_grades_only_what_is_new(tmp_path: Path) -> None:
    executor, out = StandInForGrading(), tmp_path / "out"
    first = download(tmp_path / "first.zip", Ann_A_11="right = 1", Bob_B_12="wrong = 1")
    assert scores(run(first, out, executor)) == {"11": 10.0, "12": 0.0}
    later = download(tmp_path / "later.zip", Bob_B_12="right = 2", Cem_C_13="right = 3")
    book = run(first, out, executor, more=(later,), resume=True)
    assert scores(book) == {"11": 10.0, "12": 10.0, "13": 10.0}
    assert len(executor.requests) == 4
    assert set(worksheet(book)) == {11, 12, 13}


def test_who_has_an_empty_folder_is_on_the_roster_once_and_has_handed_in_nothing(tmp_path: Path) -> None:
    inbox = download(tmp_path / "in.zip", Ann_A_11="right = 1", Bob_B_12="")
    book = run(inbox, tmp_path / "out", StandInForGrading(), roster=class_list(tmp_path, PARTICIPANTS))
    assert book.absent == (("12", "Bob B"), ("cem@x.example", "Cem C"))
    assert book.missing == (("12", SERVICE.id), ("cem@x.example", SERVICE.id))
    assert book.unknown == ()


@pytest.mark.parametrize("called", ["12", "Bob B"])
def test_a_score_by_hand_stays_a_students_when_they_hand_something_in(tmp_path: Path, called: str) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "overrides.csv").write_text(f"student,exercise,score,comment\n{called},{SERVICE.id},7.5,By hand\n")
    (out / "class.toml").write_text('timezone = "UTC"\n')
    (out / "extensions.csv").write_text(f"student,exercise,due\n{called},,2026-11-20 23:59\n")
    people = class_list(tmp_path, WORKSHEET)
    before = download(tmp_path / "before.zip", Ann_A_11="right = 1", Bob_B_12="")
    book = run(before, out, StandInForGrading(), roster=people)
    assert worksheet(book)[12]["Grade"] == "7.5"
    after = download(tmp_path / "after.zip", Ann_A_11="right = 1", Bob_B_12="right = 2")
    book = run(after, out, StandInForGrading(), roster=people, resume=True)
    assert scores(book) == {"11": 10.0, "12": 7.5}
    assert [one.adjustment.extended for one in book.records] == [False, True]


def test_a_score_for_somebody_absent_is_in_moodles_worksheet_where_the_roster_has_their_number(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "overrides.csv").write_text(f"student,exercise,score,comment\nCem C,{SERVICE.id},6,Told me\n")
    inbox = download(tmp_path / "in.zip", Ann_A_11="right = 1")
    book = run(inbox, out, StandInForGrading(), roster=class_list(tmp_path, WORKSHEET))
    assert {number: row["Grade"] for number, row in worksheet(book).items()} == {11: "10", 13: "6"}
    book = run(inbox, out, StandInForGrading(), roster=class_list(tmp_path, PARTICIPANTS), resume=True)
    assert set(worksheet(book)) == {11}  # a list of participants has no numbers of the assignment
    assert scores(book)["cem@x.example"] == 6.0


def test_what_is_wrong_with_names_numbers_and_dates_in_both_files_is_told_at_once(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "overrides.csv").write_text(
        f"student,exercise,score,comment\nbo,{SERVICE.id},5,\n11,{SERVICE.id},90,\n12,{SERVICE.id},1,\nBob B,"
        f"{SERVICE.id},2,\n"
    )
    (out / "extensions.csv").write_text("student,exercise,due\n11,,soon\nzoe,,2026-11-20T23:59+00:00\n")
    inbox = download(tmp_path / "in.zip", Ann_A_11="right = 1", Bob_B_12="right = 1")
    executor = StandInForGrading()
    with pytest.raises(GradingError) as told:
        run(inbox, out, executor)
    said = str(told.value)
    for mistake in (
        "line 2: due: 'soon' is not a date with a time",
        "line 3: there is no student 'zoe' here",
        "line 2: there is no student 'bo' here",
        "line 3: the score '90' is not a number from 0 to 10",
        "line 5: Bob B is 12, who stands in line 4 already",
    ):
        assert mistake in said
    assert executor.requests == []


def refused(tmp_path: Path, called: str, **programs: str) -> str:
    """What is said where `overrides.csv` calls somebody so."""
    out = tmp_path / "out"
    out.mkdir()
    (out / "overrides.csv").write_text(f"student,exercise,score,comment\n{called},{SERVICE.id},5,\n")
    with pytest.raises(GradingError) as told:
        run(download(tmp_path / "in.zip", **programs), out, StandInForGrading())
    return str(told.value)


def test_a_name_of_two_students_is_refused_with_what_tells_them_apart(tmp_path: Path) -> None:
    said = refused(tmp_path, "Ann A", Ann_A_11="right = 1", Ann_A_14="right = 2")
    assert "line 2: several are called 'Ann A': 11, 14. Write" in said

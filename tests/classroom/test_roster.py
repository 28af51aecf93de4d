"""Class lists of several systems and languages: who is who, and who has not handed in."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom.intake import collecting, roster
from course_kit.grading import GradingError

from .accidents import SERVICE, program
from .system_inboxes import PEOPLE, Maker

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


def csv_of(rows: Sequence[Sequence[str]], delimiter: str = ",") -> str:
    file = io.StringIO(newline="")
    csv.writer(file, delimiter=delimiter).writerows(rows)
    return file.getvalue()


ABSENT = ("Absent", "Ned", "st900", "9900", "900")  # last name, first name, login, Canvas's number, Moodle's
EVERYBODY = [*((p.last, p.first, p.login, p.canvas, str(100 + p.number)) for p in PEOPLE), ABSENT]

OF_CANVAS = csv_of(
    [
        ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", "Week 3 (4711)"],
        ["", "", "", "", "", "Manual Posting"],
        ["    Points Possible", "", "", "", "", "10"],
        *([f"{last}, {first}", canvas, f"S{canvas}", login, "A", ""] for last, first, login, canvas, _ in EVERYBODY),
        ["Student, Test", "1", "", "abc", "A", ""],
    ]
)
OF_MOODLE = csv_of(
    [
        ["ID", "Vollständiger Name", "E-Mail-Adresse", "Status", "Bewertung"],
        *(
            [f"Teilnehmer/in {number}", f"{first} {last}", f"{login}@uni.example", "Nicht abgegeben", ""]
            for last, first, login, _, number in EVERYBODY
        ),
    ]
)
OF_NBGRADER = csv_of(
    [
        ["id", "first_name", "last_name", "email", "lms_user_id"],
        *([login, first, last, f"{login}@uni.example", ""] for last, first, login, _, _ in EVERYBODY),
    ]
)
FRENCH = csv_of(
    [
        ["Nom", "Prénom", "Adresse de courriel", "Numéro d'identification"],
        *([last, first, f"{login}@uni.example", login] for last, first, login, _, _ in EVERYBODY),
    ],
    ";",
)
NO_HEADER = csv_of([[f"{login}@uni.example", f"x{login}"] for _, _, login, _, _ in EVERYBODY], "\t")


@pytest.mark.parametrize(
    ("system", "text", "encoding", "read_as"),
    [
        ("canvas", OF_CANVAS, "utf-8-sig", {"Student": "full name", "ID": "Canvas user number"}),
        ("moodle", OF_MOODLE, "utf-8-sig", {"ID": "Moodle participant", "Vollständiger Name": "full name"}),
        ("nbgrader", OF_NBGRADER, "utf-8", {"id": "login", "first_name": "first name", "last_name": "last name"}),
        ("github", OF_NBGRADER, "utf-8", {"id": "login"}),
        ("gradescope", OF_NBGRADER, "utf-16", {"id": "login"}),
        ("folders", FRENCH, "utf-8", {"Nom": "last name", "Prénom": "first name"}),
        ("folders", NO_HEADER, "ascii", {"column 1": "e-mail address"}),
    ],
)
def test_a_list_gives_names_and_says_who_is_absent(
    tmp_path: Path, system: str, text: str, encoding: str, read_as: dict[str, str]
) -> None:
    source = Maker(system, tmp_path).source
    (tmp_path / "list.csv").write_bytes(text.encode(encoding))
    people = roster.read_roster(tmp_path / "list.csv")
    assert read_as.items() <= dict(people.read_as).items()
    assert len(people.people) == len(EVERYBODY)
    found = collecting.collect_submissions(source, (SERVICE,), tmp_path / "handed_in", roster=people)
    assert found.roster is not None
    assert found.roster.unknown == ()
    assert found.roster.matched == len(PEOPLE)
    [away] = found.roster.absent
    absent, name = away.student, away.name
    assert name == ("" if text == NO_HEADER else "Ned Absent")
    assert (absent, SERVICE.id) in found.missing
    assert [row.why for row in collecting.intake_rows(found) if row.student == absent] == ["not handed in"]
    if text != NO_HEADER:
        names = {entry.student: entry.name for entry in found.entries}
        assert sorted(names.values()) == sorted(person.name for person in PEOPLE)


def test_names_join_where_no_identifier_does(tmp_path: Path) -> None:
    for folder in ("Doe, Jane", "MÜLLER Jörg", "nobody", "Li Na"):
        (tmp_path / "in" / folder).mkdir(parents=True)
        (tmp_path / "in" / folder / SERVICE.starter).write_bytes(program(len(folder)))
    (tmp_path / "list.csv").write_text("Name;Vorname;Matrikelnummer\nDoe;Jane;1\nMüller;Jörg;2\nLi;Na;3\nNa;Li;4\n")
    people = roster.read_roster(tmp_path / "list.csv")
    assert dict(people.read_as) == {"Name": "last name", "Vorname": "first name", "Matrikelnummer": "student number"}
    found = collecting.collect_submissions(tmp_path / "in", (SERVICE,), tmp_path / "handed_in", roster=people)
    assert found.roster is not None
    assert {entry.student: (entry.name, entry.platform.get("sid")) for entry in found.entries} == {
        "Doe, Jane": ("Jane Doe", "1"),
        "MÜLLER Jörg": ("Jörg Müller", "2"),
        "Li Na": ("", None),
        "nobody": ("", None),
    }
    assert dict(found.roster.unknown) == {"Li Na": "several on the list have this name", "nobody": "not on the list"}


def test_the_work_of_a_group_is_everybodys_in_it_and_its_number_is_no_participants(tmp_path: Path) -> None:
    folder = tmp_path / "in/Team A_11_assignsubmission_file"
    folder.mkdir(parents=True)
    (folder / SERVICE.starter).write_bytes(program(1))
    (tmp_path / "list.csv").write_text(
        "Identifier,Full name,Email address,Group\n"
        "Participant 11,Cem C,c@x.example,Team B\nParticipant 12,Ann A,a@x.example,Team A\n"
        "Participant 13,Bob B,b@x.example,Team A\n"
    )
    people = roster.read_roster(tmp_path / "list.csv")
    found = collecting.collect_submissions(tmp_path / "in", (SERVICE,), tmp_path / "handed_in", roster=people)
    assert {(entry.name, entry.platform["moodle_participant"], entry.platform["group"]) for entry in found.entries} == {
        ("Ann A", "12", "Team A"),
        ("Bob B", "13", "Team A"),
    }
    assert found.roster is not None
    assert [one.name for one in found.roster.absent] == ["Cem C"]
    assert found.missing == (("c@x.example", SERVICE.id),)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "is empty"),
        (b"colour,size\nred,1\n", "looks like names, e-mail addresses or student numbers. Its columns are: column 1"),
        (b"name,email\n", "lists nobody"),
    ],
)
def test_a_list_of_something_else_is_said(tmp_path: Path, content: bytes, sentence: str) -> None:
    (tmp_path / "list.csv").write_bytes(content)
    with pytest.raises(GradingError, match=sentence):
        roster.read_roster(tmp_path / "list.csv")
    with pytest.raises(GradingError, match="No such file"):
        roster.read_roster(tmp_path / "nowhere.csv")

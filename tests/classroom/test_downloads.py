"""Several downloads of one class, folders that others have put around the students, and groups."""

from __future__ import annotations

import zipfile
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom.intake import collecting
from course_kit.grading import GradingError
from course_kit.grading.model.exercise import load_exercise

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

SERVICE = load_exercise("temperature_service")
ROBOT = load_exercise("move_robot")
SERVICE_PY, ROBOT_PY = SERVICE.starter, ROBOT.starter
NAMES = ("ann", "bob", "cem", "dee")


def pack(path: Path, files: Mapping[str, str]) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w") as packed:
        for name, text in files.items():
            member = zipfile.ZipInfo("x", (2026, 11, 1, 12, 0, 0))
            member.filename = name
            packed.writestr(member, text)
    return path


def canvas(program: str, upload: int) -> dict[str, str]:
    return {f"{name}_{number}_{upload + number}_{program}": f"# {name}" for number, name in enumerate(NAMES, start=11)}


def moodle(program: str, first: int) -> dict[str, str]:
    return {f"{name}_{first + k}_assignsubmission_file/{program}": f"# {name}" for k, name in enumerate(NAMES)}


def collect(tmp_path: Path, *sources: Path, layout: str = "auto") -> collecting.Intake:
    return collecting.collect_submissions(sources, (SERVICE, ROBOT), tmp_path / "workspace", layout)


def handed_in(found: collecting.Intake) -> dict[str, dict[str, str]]:
    table: dict[str, dict[str, str]] = {}
    for entry in found.entries:
        table.setdefault(entry.student, {})[entry.exercise] = entry.source
    return table


@pytest.mark.parametrize("in_a_folder", [False, True])
def test_canvas_gives_a_zip_for_each_assignment(tmp_path: Path, in_a_folder: bool) -> None:
    first = pack(tmp_path / "in/submissions.zip", canvas("answer_temperature_service.py", 100))
    second = pack(tmp_path / "in/submissions (1).zip", canvas(ROBOT_PY, 200))
    found = collect(tmp_path, tmp_path / "in") if in_a_folder else collect(tmp_path, first, second)
    assert handed_in(found) == {
        str(number): {
            SERVICE.id: f"submissions/{name}_{number}_{100 + number}_answer_temperature_service.py",
            ROBOT.id: f"submissions (1)/{name}_{number}_{200 + number}_{ROBOT_PY}",
        }
        for number, name in enumerate(NAMES, start=11)
    }
    assert all((found.root / entry.source).read_text() == f"# {entry.name}" for entry in found.entries)


def test_a_download_that_is_named_after_an_exercise_says_what_its_files_are_for(tmp_path: Path) -> None:
    one = pack(tmp_path / "in/temperature_service.zip", {f"{name}/answer.py": f"a = '{name}'" for name in NAMES})
    two = pack(tmp_path / "in/move-robot.zip", {f"{name}/answer.py": f"b = '{name}'" for name in NAMES})
    found = collect(tmp_path, one, two)
    assert handed_in(found) == {
        name: {SERVICE.id: f"temperature_service/{name}/answer.py", ROBOT.id: f"move-robot/{name}/answer.py"}
        for name in NAMES
    }
    assert handed_in(collect(tmp_path, tmp_path / "in")) == handed_in(found)


def test_moodles_numbers_join_nothing_but_names_do(tmp_path: Path) -> None:
    """The number 12 is bob's in one assignment and ann's in the other."""
    one, two = pack(tmp_path / "a.zip", moodle(SERVICE_PY, 11)), pack(tmp_path / "b.zip", moodle(ROBOT_PY, 12))
    found = collect(tmp_path, one, two)
    assert {student: set(exercises) for student, exercises in handed_in(found).items()} == {
        name: {SERVICE.id, ROBOT.id} for name in NAMES
    }
    numbers = {(entry.student, entry.exercise): entry.platform["moodle_participant"] for entry in found.entries}
    assert (numbers["bob", SERVICE.id], numbers["bob", ROBOT.id]) == ("12", "13")
    assert found.odd == ()


def test_work_of_moodles_default_group_is_no_participants(tmp_path: Path) -> None:
    group = {
        f"Default group_assignsubmission_file/{SERVICE_PY}": "1",
        f"Team A_77_assignsubmission_file/{SERVICE_PY}": "2",
    }
    found = collecting.collect_submissions(pack(tmp_path / "a.zip", group), (SERVICE,), tmp_path / "workspace")
    assert {entry.student: entry.platform for entry in found.entries} == {
        "Default group": {"group": "Default group"},
        "77": {"group": "Team A"},
    }


WRAPPED = {
    "canvas": canvas(SERVICE_PY, 100),
    "moodle": moodle(SERVICE_PY, 11),
    "folders": {f"{name}/{SERVICE_PY}": name for name in NAMES},
    "files": {f"{name}_{SERVICE_PY}": name for name in NAMES},
    "nbgrader": {f"submitted/{name}/week/{SERVICE_PY}": name for name in NAMES},
}


@pytest.mark.parametrize("layout", WRAPPED)
@pytest.mark.parametrize(("around", "mac"), [("class", False), ("anything", True)])
def test_a_folder_around_the_students_is_no_student(tmp_path: Path, layout: str, around: str, mac: bool) -> None:
    files = {f"{around}/{name}": text for name, text in WRAPPED[layout].items()}
    if mac:
        files |= {f"__MACOSX/{around}/._{name.replace('/', '_')}": "\0" for name in WRAPPED[layout]}
    found = collecting.collect_submissions(pack(tmp_path / "class.zip", files), (SERVICE,), tmp_path / "workspace")
    assert found.layout == layout
    assert len({entry.student for entry in found.entries}) == len(NAMES)
    assert (found.dropped, found.odd) == ((), ())


def test_a_class_in_a_folder_that_could_be_a_student_is_asked_for(tmp_path: Path) -> None:
    for name in NAMES:
        (tmp_path / "in/spring" / name).mkdir(parents=True)
        (tmp_path / "in/spring" / name / SERVICE_PY).write_text(name)
    with pytest.raises(GradingError, match="'spring', which seems to hold the students"):
        collect(tmp_path, tmp_path / "in")
    assert len(collect(tmp_path, tmp_path / "in/spring").entries) == len(NAMES)
    assert len(collect(tmp_path, tmp_path / "in", layout="folders").entries) == 1


CANVAS_NAMES = {
    "doejane_12345_67890_answer.py": ("12345", "doejane", "answer.py", False),
    "vander_berg_12345_67890_my_2_answers-10.py": ("12345", "vander_berg", "my_2_answers.py", False),
    "anon_a1B2c_67890_answer.py": ("anon_a1B2c", "", "answer.py", False),
    "anon_a1B2c_LATE_67890_answer.py": ("anon_a1B2c", "", "answer.py", True),
    "team7_12345_67890_answer-0a1b2c3d-0a1b-0a1b-0a1b-0a1b2c3d4e5f.py": ("12345", "team7", "answer.py", False),
    "doejane_LATE_12345_text.html": ("12345", "doejane", "text.html", True),
}


@pytest.mark.parametrize("name", CANVAS_NAMES)
def test_names_as_canvas_writes_them(name: str) -> None:
    from course_kit.classroom.intake import layouts
    from course_kit.classroom.intake.listing import FILE, Item

    unit = layouts.read_canvas(Item(name, FILE))
    assert unit is not None
    assert (unit.student, unit.name, unit.file, unit.late) == CANVAS_NAMES[name]
    assert unit.platform.get("canvas_user", "") == ("" if unit.student.startswith("anon") else "12345")


def test_a_group_of_gradescope_is_each_of_its_members(tmp_path: Path) -> None:
    metadata = (
        "submission_1:\n  :submitters:\n  - :name: Ann\n    :sid: '1'\n    :email: ann@x.example\n"
        "  - :name: \"J\\xF6rg\"\n    :sid: '2'\n  :created_at: 2026-11-01 12:00:00.000000000 Z\n"
        "submission_2:\n  :submitters:\n  - :name: Cem\n    :sid:\n    :email: cem@x.example\n"
    )
    files = {f"assignment_9_export/submission_{one}/{SERVICE_PY}": f"# {one}" for one in (1, 2, 3)}
    source = pack(tmp_path / "all.zip", {**files, "assignment_9_export/submission_metadata.yml": metadata})
    found = collecting.collect_submissions(source, (SERVICE,), tmp_path / "workspace")
    entries = {entry.student: entry for entry in found.entries}
    assert entries.keys() == {"1", "2", "cem@x.example", "submission_3"}
    assert (entries["1"].source, entries["1"].name) == (entries["2"].source, "Ann")
    assert entries["2"].name == "Jörg"
    assert entries["2"].platform["group"] == entries["1"].platform["group"] == "submission_1"
    assert entries["1"].platform["submitted_at"].startswith("2026-11-01 12:00:00")

"""Who handed in what, in every layout; nothing is dropped."""

from __future__ import annotations

import zipfile
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom.intake import collecting
from course_kit.grading import GradingError
from course_kit.grading.model.exercise import Exercise, load_exercise, read_exercise
from tests import several_files

if TYPE_CHECKING:
    from pathlib import Path

SERVICE = load_exercise("temperature_service")
ROBOT = load_exercise("move_robot")
CHOICE = load_exercise("pattern_choice")


def lay_out(root: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    return root


def collect(root: Path, *exercises: Exercise, layout: str = "auto") -> collecting.Intake:
    return collecting.collect_submissions(root, exercises or (SERVICE,), root.parent / "workspace", layout)


CANVAS = {
    "doejane_12345_67890_temperature_service.py": "1",
    "doejane_12345_67891_temperature_service-1.py": "2",
    "muellerjoerg_LATE_222_333_temperature_service.ipynb": "{}",
    "notes.txt": "",
}
MOODLE = {
    "Jane Doe_4711_assignsubmission_file_/temperature_service.py": "1",
    "Jörg Müller, jr._4712_assignsubmission_file_/my answer.py": "2",
    "Jörg Müller, jr._4712_assignsubmission_onlinetext_/onlinetext.html": "<p>",
}
NBGRADER = {
    "submitted/jane/week 3/temperature_service.ipynb": "{}",
    "submitted/jane/week 3/timestamp.txt": "2026-11-21",
    "submitted/jörg/week 3/temperature_service.ipynb": "{}",
}
GITHUB = {
    "services-submissions/services-jane-doe/temperature_service.py": "1",
    "services-submissions/services-jane-doe/.git/config": "[core]",
    "services-submissions/services-jorg/src/temperature_service.py": "2",
    "services-submissions/services-jorg/README.md": "hello",
}
FOLDERS = {"jane/temperature_service.py": "1", "jörg 😀/answer.py": "2"}
FILES = {"jane.py": "1", "jörg_temperature_service.py": "2"}


@pytest.mark.parametrize(
    ("layout", "files", "students"),
    [
        ("canvas", CANVAS, ["12345", "222"]),
        ("moodle", MOODLE, ["4711", "4712"]),
        ("nbgrader", NBGRADER, ["jane", "jörg"]),
        ("github", GITHUB, ["jane-doe", "jorg"]),
        ("folders", FOLDERS, ["jane", "jörg 😀"]),
        ("files", FILES, ["jane", "jörg"]),
    ],
)
def test_each_layout_is_recognised_and_every_file_is_accounted_for(
    tmp_path: Path, layout: str, files: dict[str, str], students: list[str]
) -> None:
    found = collect(lay_out(tmp_path / "in", files))
    assert found.layout == layout
    assert sorted(entry.student for entry in found.entries) == students
    accounted = {entry.source for entry in found.entries} | {path for path, _ in found.left}
    assert all(name in accounted or any(name.startswith(f"{path}/") for path in accounted) for name in files)


def test_canvas_tells_who_is_late_and_the_latest_attempt_counts(tmp_path: Path) -> None:
    found = collect(lay_out(tmp_path / "in", CANVAS))
    jane, joerg = sorted(found.entries, key=lambda entry: entry.student)
    assert (jane.source, jane.name, jane.late) == ("doejane_12345_67891_temperature_service-1.py", "doejane", False)
    assert jane.platform == {"canvas_user": "12345", "canvas_submission": "67891"}
    assert joerg.late
    left = dict(found.left)
    assert left["doejane_12345_67890_temperature_service.py"] == f"an earlier upload; {jane.source} was used instead"
    assert left["notes.txt"] == "its name does not follow the layout 'canvas'"


def test_with_several_exercises_each_file_goes_to_its_own_by_name_or_by_content(tmp_path: Path) -> None:
    files = {
        "jane/temperature_service.py": "",
        "jane/second.py": "class MoveRobotServer(Node):\n    pass\n",
        "jane/quiz.ipynb": '{"cells": [{"source": ["%%submission pattern_choice\\n"]}]}',
        "jane/other.py": "print(1)",
        "joe/week_move_robot_final.py": "",
    }
    found = collect(lay_out(tmp_path / "in", files), SERVICE, ROBOT, CHOICE)
    assert [(entry.student, entry.exercise, entry.source) for entry in found.entries] == [
        ("jane", "temperature_service", "jane/temperature_service.py"),
        ("jane", "move_robot", "jane/second.py"),
        ("jane", "pattern_choice", "jane/quiz.ipynb"),
        ("joe", "move_robot", "joe/week_move_robot_final.py"),
    ]
    assert found.left == (("jane/other.py", "it belongs to none of these exercises"),)
    assert found.missing == (("joe", "temperature_service"), ("joe", "pattern_choice"))


def test_a_single_file_of_a_wrong_kind_is_still_a_submission_that_gets_a_report(tmp_path: Path) -> None:
    found = collect(lay_out(tmp_path / "in", {"jane/essay.pdf": "%PDF", "joe/temperature_service.py": ""}))
    assert [entry.source for entry in found.entries] == ["jane/essay.pdf", "joe/temperature_service.py"]
    assert [entry.worry for entry in found.entries] == ["it is neither a .py nor an .ipynb file", "it is empty"]


def test_what_is_no_archive_or_not_there_is_said(tmp_path: Path) -> None:
    (tmp_path / "broken.zip").write_bytes(b"PK\x03\x04 and then nothing")
    with pytest.raises(GradingError, match=r"broken\.zip cannot be read as a zip archive"):
        collect(tmp_path / "broken.zip")
    with pytest.raises(GradingError, match="no folder or zip"):
        collect(tmp_path / "nowhere")
    (tmp_path / "empty").mkdir()
    with pytest.raises(GradingError, match="No files"):
        collect(tmp_path / "empty")


NO_PROGRAMS = ("essay.pdf", "photo.png", "answer.txt", "text.html", "link.html")


def entry_in(layout: str, number: str, name: str, file: str) -> str:
    """Where a platform puts a file."""
    if layout == "canvas":
        upload = "" if file in ("text.html", "link.html") else "900_"
        return f"{name}_{number}_{upload}{file}"
    folders = {
        "moodle": f"{name}_{number}_assignsubmission_file_",
        "gradescope": f"submission_{number}",
        "nbgrader": f"submitted/{name}/week 1",
        "github": f"services-{name}",
    }
    return f"{folders.get(layout, name)}/{file}"


@pytest.mark.parametrize(
    ("layout", "wrapping"),
    [
        ("canvas", "zip"),
        ("moodle", "several zips"),
        ("gradescope", "folder of zips"),
        ("nbgrader", "folder"),
        ("github", "zip"),
        ("folders", "several zips"),
    ],
)
def test_what_is_no_program_is_there_to_get_its_report(tmp_path: Path, layout: str, wrapping: str) -> None:
    downloads = []
    for set_ in (SERVICE, ROBOT):
        files = {entry_in(layout, f"{20 + k}", f"student{k}", set_.starter): "x" for k in range(len(NO_PROGRAMS) + 1)}
        files |= {entry_in(layout, f"{10 + k}", f"dee{k}", f): f for k, f in enumerate(NO_PROGRAMS)}
        root = lay_out(tmp_path / "laid out" / set_.id, files)
        packed = tmp_path / "in" / f"{set_.id}.zip"
        packed.parent.mkdir(exist_ok=True)
        with zipfile.ZipFile(packed, "w") as archive_:
            for name in files:
                archive_.write(root / name, name)
        downloads.append(root if wrapping == "folder" else packed)
    sources = [tmp_path / "in"] if wrapping == "folder of zips" else downloads
    exercises = (SERVICE, ROBOT)
    if wrapping in ("folder", "zip"):
        sources, exercises = sources[:1], exercises[:1]
    found = collecting.collect_submissions(
        sources, exercises, tmp_path / "workspace", "auto" if len(sources) == 1 else layout
    )
    texts = [(found.root / entry.source).read_text() for entry in found.entries]
    assert sorted(text for text in texts if text != "x") == sorted([*NO_PROGRAMS] * len(exercises))


CLASS = "import rclpy\nclass TemperatureService(Node):\n    pass\n"
SCRIPT = "import rclpy\nrclpy.init()\nnode = rclpy.create_node('t')\nrclpy.spin(node)\n"


def test_the_last_upload_counts_where_it_is_a_script_without_the_class(tmp_path: Path) -> None:
    files = {"ann_1_10_temperature_service.py": CLASS, "ann_1_20_temperature_service-1.py": SCRIPT}
    [entry] = collect(lay_out(tmp_path / "in", files)).entries
    assert entry.source == "ann_1_20_temperature_service-1.py"
    assert entry.why.startswith("the last upload of 2 files")
    assert entry.worry == "ann_1_10_temperature_service.py holds TemperatureService, and this one does not"


@pytest.mark.parametrize(
    ("name", "content", "worry"),
    [
        ("temperature_service.py", b"import rclpy\nclass MoveRobotServer(Node):\n    pass\n", "it holds MoveRobot"),
        ("temperature_service.py", b"", "it is empty"),
        ("temperature_service.py", CLASS.encode("utf-16"), "no program can be read in it"),
        (
            "temperature_service.ipynb",
            b'{"cells": [{"cell_type": "code", "source": "x"}]}',
            "no cell in it can be read",
        ),
        ("temperature_service.py", b"print(1)\n", "it does not contain TemperatureService"),
        ("temperature_service.py", CLASS.encode(), ""),
    ],
)
def test_what_will_hardly_get_a_point_is_among_what_to_look_at(
    tmp_path: Path, name: str, content: bytes, worry: str
) -> None:
    lay_out(tmp_path / "in", {f"ann/{name}": ""})
    (tmp_path / "in/ann" / name).write_bytes(content)
    [entry] = collect(tmp_path / "in").entries
    assert entry.worry.startswith(worry)
    assert bool(entry.worry) == bool(worry)


def test_a_folder_a_notebook_a_zip_and_a_repository_of_a_student_are_one_submission_each(tmp_path: Path) -> None:
    exercise, handed_in = read_exercise(several_files.write(tmp_path)), tmp_path / "in"
    several_files.write_files(handed_in / "ann", gate_py="print(1)")
    several_files.write_files(handed_in / "ben" / "src" / "mine", guard_py=None, gate_py="print(2)")
    (handed_in / "ben" / ".git").mkdir()
    (handed_in / "ben" / ".git" / "config").write_text("[core]")
    (handed_in / "cem").mkdir()
    (handed_in / "cem" / "answer.ipynb").write_text(several_files.notebook(gate_py="print(3)"))
    (handed_in / "dee").mkdir()
    several_files.zipped(tmp_path / "dee.zip", gate_py="print(4)").rename(handed_in / "dee" / "answer.zip")
    found = collect(handed_in, exercise, layout="folders")
    assert {entry.student: entry.source for entry in found.entries} == {
        "ann": "ann",
        "ben": "ben/src/mine",
        "cem": "cem/answer.ipynb",
        "dee": "dee/answer.zip.contents/dee",
    }
    assert {entry.student: entry.worry for entry in found.entries if entry.worry} == {"ben": "missing: guard.py"}
    assert dict(found.left) == {"ben/.git": "a folder of a tool"}


@pytest.mark.parametrize("packed", [True, False], ids=["zip", "folder"])
@pytest.mark.parametrize(
    ("layout", "named"),
    [
        ("moodle", "{first} {last}_{number}_assignsubmission_file/{file}"),
        ("gradescope", "submission_{number}/{file}"),
    ],
    ids=["moodle", "gradescope"],
)
def test_several_files_of_a_student_are_one_submission_however_a_platform_names_them(
    tmp_path: Path, layout: str, named: str, *, packed: bool
) -> None:
    exercise = read_exercise(several_files.write(tmp_path / "course"))
    whole = several_files.FILES
    handed_in = {
        ("ann", "lee", 901): {**whole, "own.py": "X = 1", "temperature_service.py": "print(1)"},
        ("ben", "mo", 902): {name: text for name, text in whole.items() if name != "guard.py"},
        ("cem", "no", 903): {"temperature_service.py": "print(2)"},
        ("dee", "po", 904): {"pair.yaml": whole["pair.yaml"]},
    }
    files = {
        named.format(first=first, last=last, number=number, file=name): text
        for (first, last, number), of_one in handed_in.items()
        for name, text in of_one.items()
    }
    source = lay_out(tmp_path / "in", files)
    if packed:
        with zipfile.ZipFile(tmp_path / "in.zip", "w") as archive:
            for name, text in files.items():
                archive.writestr(name, text)
        source = tmp_path / "in.zip"
    found = collect(source, SERVICE, exercise, layout=layout)
    by_number = {(entry.student[-3:], entry.exercise): entry for entry in found.entries}
    assert sorted(by_number) == [
        ("901", exercise.id),
        ("901", SERVICE.id),
        ("902", exercise.id),
        ("903", SERVICE.id),
        ("904", exercise.id),
    ]
    read = {key: found.root / entry.source for key, entry in by_number.items()}
    assert {one.name: one.read_text() for one in read["901", exercise.id].iterdir()} == handed_in["ann", "lee", 901]
    assert read["901", SERVICE.id].read_text() == "print(1)"
    assert sorted(one.name for one in read["902", exercise.id].iterdir()) == ["gate.py", "pair.launch.py", "pair.yaml"]
    assert by_number["902", exercise.id].worry == "missing: guard.py"
    assert by_number["904", exercise.id].worry == "missing: gate.py, guard.py, pair.launch.py"
    assert (found.left, found.dropped, found.odd) == ((), (), ())


def test_loose_files_of_an_exercise_of_several_need_a_look(tmp_path: Path) -> None:
    exercise = read_exercise(several_files.write(tmp_path / "course"))
    loose = {f"leeann_901_{place}_{name}": text for place, (name, text) in enumerate(several_files.FILES.items())}
    [entry] = collect(lay_out(tmp_path / "in", loose), exercise, layout="canvas").entries
    assert entry.source == "leeann_901_2_pair.launch.py"
    whole = "gate.py, guard.py, pair.launch.py, pair.yaml"
    assert entry.worry == f"it does not contain {whole}, all in one zip or notebook"

"""What one student hands in is never another's problem: an attack each, and what becomes of it."""

from __future__ import annotations

import os
import stat
import struct
import subprocess
import unicodedata
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom.intake import archive, collecting, listing
from course_kit.grading import GradingError
from course_kit.grading.model.exercise import Exercise, load_exercise
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator


SERVICE = load_exercise("temperature_service")
PROGRAM = "temperature_service.py"
OTHERS = ("ann", "bob", "cem")


def collect(source: Path, *exercises: Exercise, layout: str = "auto") -> collecting.Intake:
    return collecting.collect_submissions(source, exercises or (SERVICE,), source.parent / "workspace", layout)


def lay_out(root: Path, files: Iterable[str | bytes], text: str = "pass\n") -> Path:
    for name in files:
        path = Path(os.fsdecode(os.path.join(os.fsencode(root), os.fsencode(name))))  # noqa: PTH118 - bytes
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


def taken(found: collecting.Intake) -> dict[str, str]:
    return {entry.student: entry.source for entry in found.entries}


IN_FOLDERS = {student: f"{student}/{PROGRAM}" for student in OTHERS}
IN_CANVAS = {f"{number}": f"{name}_{number}_9{number}_{PROGRAM}" for number, name in enumerate(OTHERS, start=11)}
IN_MOODLE = {
    f"{number}": f"{name}_{number}_assignsubmission_file_/{PROGRAM}" for number, name in enumerate(OTHERS, start=11)
}
IN_NBGRADER = {student: f"submitted/{student}/week/{PROGRAM}" for student in OTHERS}
IN_GITHUB = {student: f"week-submissions/week-{student}/{PROGRAM}" for student in OTHERS}
IN_FILES = {student: f"{student}.py" for student in OTHERS}

EVIL_INSIDE = [
    f"bob_12_assignsubmission_file_/{PROGRAM}",
    f"submitted/bob/week/{PROGRAM}",
    f"submitted/bob/week/{PROGRAM}x/timestamp.txt",
    f"week-submissions/week-bob/{PROGRAM}",
    f"x-submissions/bob/{PROGRAM}",
    f"bob_12_912_{PROGRAM}",
    "week/timestamp.txt",
    "bob/.git/config",
    *(f"bob{number}_{number}_9{number}_{PROGRAM}" for number in range(20, 26)),
]


@pytest.mark.parametrize(
    ("layout", "others", "own", "student"),
    [
        ("folders", IN_FOLDERS, "mallory", "mallory"),
        ("canvas", IN_CANVAS, "mallory_66_966_work", "66"),
        ("moodle", IN_MOODLE, "mallory_66_assignsubmission_file_", "66"),
        ("nbgrader", IN_NBGRADER, "submitted/mallory", "mallory"),
        ("github", IN_GITHUB, "week-submissions/week-mallory", "mallory"),
        ("files", IN_FILES, "mallory", "mallory"),
    ],
)
def test_names_inside_of_one_students_work_say_nothing_about_others(
    tmp_path: Path, layout: str, others: dict[str, str], own: str, student: str
) -> None:
    root = lay_out(tmp_path / "in", [*others.values(), *(f"{own}/{name}" for name in EVIL_INSIDE)])
    found = collect(root)
    assert found.layout == layout
    result = taken(found)
    assert result.pop(student).startswith(f"{own}/")
    assert result == others
    assert found.dropped == ()


def test_who_is_alone_in_a_folder_cannot_hand_in_for_others(tmp_path: Path) -> None:
    evil = [f"mallory/bob_12_assignsubmission_file_/{PROGRAM}", f"mallory/ann_11_assignsubmission_file_/{PROGRAM}"]
    root = lay_out(tmp_path / "in", evil)
    with pytest.raises(GradingError, match="If 'mallory' is a student, add --layout folders"):
        collect(root)
    assert set(taken(collect(root, layout="folders"))) == {"mallory"}
    assert set(taken(collect(root, layout="moodle"))) == {"11", "12"}, "then it is the instructor who says so"


def test_downloads_side_by_side_are_not_taken_for_students(tmp_path: Path) -> None:
    root = lay_out(tmp_path / "in", [f"week{week}/{name}" for week in (1, 2) for name in IN_CANVAS.values()])
    with pytest.raises(GradingError, match="several downloads from Canvas, 'week1' and others"):
        collect(root)


def test_a_moodle_file_with_two_numbers_is_nobodys_but_its_own(tmp_path: Path) -> None:
    flat = [name.replace("/", "") for name in IN_MOODLE.values()]
    evil = f"mallory_66_assignsubmission_file_bob_12_assignsubmission_file_{PROGRAM}"
    found = collect(lay_out(tmp_path / "in", [*flat, evil]))
    entries = {entry.student: entry for entry in found.entries}
    assert {entry.source for student, entry in entries.items() if student in IN_MOODLE} == set(flat)
    mallory = next(entry for entry in found.entries if entry.source == evil)
    assert mallory.platform == {}
    assert dict(found.odd)[mallory.student] == "its name can also be read as that of participant 66 or 12"


ALIKE = {
    "composed and decomposed": ("jörg", unicodedata.normalize("NFD", "jörg")),
    "letter that shows nothing": ("jane", "jane\u3164"),
    "not UTF-8": (b"j\xf6rg", b"j\xe4rg"),
    "named like a mark": ("jane ", "jane~"),
}


@pytest.mark.parametrize("names", ALIKE.values(), ids=ALIKE.keys())
def test_two_students_who_look_the_same_stay_two_and_can_be_told_apart(
    tmp_path: Path, names: tuple[str | bytes, str | bytes]
) -> None:
    folders = [os.fsencode(name) for name in names]
    found = collect(lay_out(tmp_path / "in", [folder + b"/" + PROGRAM.encode() for folder in folders]))
    students = [entry.student for entry in found.entries]
    assert len({one_line(student).replace("\ufe0f", "") for student in students}) == 2
    assert all(student.isprintable() and student == student.strip() for student in students)
    assert {os.fsencode(entry.source.partition("/")[0]) for entry in found.entries} == set(folders)


def test_links_are_not_followed_whoever_they_lead_to(tmp_path: Path) -> None:
    root = lay_out(tmp_path / "in", IN_FOLDERS.values())
    (root / "dee").symlink_to("bob")
    (root / "eve").mkdir()
    (root / "eve/src").symlink_to("../bob")
    (root / "fay.py").symlink_to(f"bob/{PROGRAM}")
    (root / "gus").symlink_to("gus")
    found = collect(root)
    assert taken(found) == IN_FOLDERS
    assert {student: reason.rpartition(": ")[2] for student, reason in found.dropped} == dict.fromkeys(
        ("dee", "eve", "fay", "gus"), "it is a link, and links are not followed"
    )


@pytest.fixture
def nested(tmp_path: Path) -> Iterator[Path]:
    """A class in which one student has folders deeper than Python recurses, and longer than a path can be."""
    root = lay_out(tmp_path / "in", IN_FOLDERS.values())
    (root / "mallory").mkdir()
    here = os.open(root / "mallory", os.O_RDONLY)
    for _ in range(1500):
        os.mkdir("deeper", dir_fd=here)
        below = os.open("deeper", os.O_RDONLY, dir_fd=here)
        os.close(here)
        here = below
    os.close(here)
    yield root
    subprocess.run(["rm", "-rf", root / "mallory"], check=True)  # Python cannot, before 3.13


def test_folders_nested_without_end_are_left(nested: Path) -> None:
    found = collect(nested)
    assert taken(found) == IN_FOLDERS
    [(student, reason)] = found.dropped
    assert student == "mallory"
    assert reason.endswith("it lies in more than 30 folders within folders")


def test_a_heap_of_files_is_its_students_problem(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(listing, "MOST", 100)
    heap = [f"mallory/{number:04}.txt" for number in range(300)]
    found = collect(
        lay_out(tmp_path / "in", [*IN_FOLDERS.values(), *heap, f"dee/{PROGRAM}", *(f"dee/{n}" for n in "abc")])
    )
    assert taken(found) == {**IN_FOLDERS, "dee": f"dee/{PROGRAM}"}
    assert dict(found.dropped) == {
        "mallory": "mallory: it holds more than 100 files and folders; the rest was not read"
    }
    assert len(found.left) < 60, "they are counted, not listed"


def test_what_systems_and_tools_leave_behind_is_nobodys(tmp_path: Path) -> None:
    junk = [".DS_Store", "__MACOSX/bob/._temperature_service.py", "bob/._temperature_service.py", ".gitignore"]
    found = collect(lay_out(tmp_path / "in", [*IN_FOLDERS.values(), *junk]))
    assert taken(found) == IN_FOLDERS
    assert found.dropped == ()
    assert {path for path, _ in found.left} == {".DS_Store", "__MACOSX", "bob/._temperature_service.py", ".gitignore"}


class Zip:
    """Writes zips that no honest tool writes."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._zip = zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED)
        for name in IN_FOLDERS.values():
            self.add(name)

    def add(
        self, name: str, data: bytes = b"pass\n", mode: int = 0, method: int = zipfile.ZIP_DEFLATED, extra: bytes = b""
    ) -> None:
        member = zipfile.ZipInfo("x")
        member.filename = name
        member.external_attr = mode << 16
        member.compress_type = method
        member.extra = extra
        self._zip.writestr(member, data)

    def close(self, change: Callable[[bytes], bytes] = lambda data: data) -> Path:
        self._zip.close()
        self.path.write_bytes(change(self.path.read_bytes()))
        return self.path


def encrypted(data: bytes) -> bytes:
    """Set the flag of Mallory's member, at both places where it stands."""
    changed = bytearray(data)
    changed[data.index(MALLORYS) - 30 + 6] |= 1
    changed[data.rindex(MALLORYS) - 46 + 8] |= 1
    return bytes(changed)


MALLORYS = b"mallory/temperature_service.py"
OUTSIDE = "its name leads outside the archive"
MEMBERS: list[tuple[str, dict[str, object], str]] = [
    ("mallory/temperature_service.py", {"mode": stat.S_IFLNK | 0o777, "data": b"../bob/x"}, "it is a link"),
    ("mallory/temperature_service.py", {"mode": stat.S_IFBLK | 0o666}, "it is not an ordinary file"),
    ("mallory/temperature_service.py", {"method": zipfile.ZIP_BZIP2}, "compressed with a method that is not supported"),
    (f"mallory/{'x' * 300}.py", {}, "its name is too long"),
    (f"{'m' * 60_000}/temperature_service.py", {}, "its name is too long"),
    (f"mallory/{'a/' * 2000}temperature_service.py", {}, "it lies in more than 40 folders"),
    (f"mallory/{'y' * 250}/{'/'.join(['z' * 250] * 20)}/a.py", {}, "it cannot be unpacked: File name too long"),
    ("mallory/../bob/temperature_service.py", {}, OUTSIDE),
    ("/bob/temperature_service.py", {}, OUTSIDE),
]


@pytest.mark.parametrize(("name", "how", "reason"), MEMBERS, ids=[f"{one[0][:40]} {one[2][:30]}" for one in MEMBERS])
def test_a_member_that_cannot_be_had_is_named_and_everybody_else_is_there(
    tmp_path: Path, name: str, how: dict[str, object], reason: str
) -> None:
    packed = Zip(tmp_path / "all.zip")
    packed.add(name, **how)  # type: ignore[arg-type]
    found = collect(packed.close())
    assert taken(found) == IN_FOLDERS
    [(_, told)] = found.dropped
    assert reason in told
    assert len(told) < 400
    assert any(reason in one for _, one in found.left)
    assert {path.name for path in tmp_path.iterdir()} == {"all.zip", "workspace", ".workspace_is_unpacked"}
    assert all(path.is_file() and path.read_bytes() == b"pass\n" for path in (tmp_path / "workspace").glob("*/*.py"))


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (encrypted, "it is encrypted"),
        (lambda data: data.replace(b"#corrupt#", b"#corrupT#"), "cannot be unpacked: Bad CRC-32"),
        (lambda data: data.replace(b"mallory/temp", b"mallory/tEmp", 1), "cannot be unpacked: File name in directory"),
    ],
    ids=["encrypted", "corrupt", "two names"],
)
def test_a_broken_member_is_not_half_there(tmp_path: Path, change: Callable[[bytes], bytes], reason: str) -> None:
    packed = Zip(tmp_path / "all.zip")
    packed.add("mallory/temperature_service.py", b"#corrupt#\n", method=zipfile.ZIP_STORED)
    packed.add("mallory/old.py", b"class TemperatureService(Node):\n    pass\n")
    found = collect(packed.close(change))
    assert taken(found) == IN_FOLDERS, "an older file is not graded in its place"
    [(student, told)] = found.dropped
    assert (student, told.partition(": ")[0]) == ("mallory", "mallory/temperature_service.py")
    assert reason in told
    assert not (tmp_path / "workspace/mallory/temperature_service.py").exists()


def test_a_bomb_takes_its_student_along_and_nobody_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archive, "LARGEST_OF_ONE", 10_000)
    monkeypatch.setattr(archive, "MOST_OF_ONE", 5)
    packed = Zip(tmp_path / "all.zip")
    packed.add("mallory/temperature_service.py", b"0" * 20_000)
    packed.add("dee/temperature_service.py", b"pass\n")
    packed.add("dee/video.mp4", b"0" * 50_000)
    for number in range(20):
        packed.add(f"eve/{number}.py")
    found = collect(packed.close())
    assert taken(found) == {**IN_FOLDERS, "dee": "dee/temperature_service.py"}
    assert "at most 5 files of 0 MB together" in dict(found.dropped)["mallory"]
    assert {path.name for path in (tmp_path / "workspace/dee").iterdir()} == {"temperature_service.py"}
    assert len(list((tmp_path / "workspace/eve").iterdir())) == 5


def test_a_member_that_is_larger_than_it_says_is_not_unpacked(tmp_path: Path) -> None:
    packed = Zip(tmp_path / "all.zip")
    packed.add("mallory/temperature_service.py", b"0" * 5_000_000)

    def lie(data: bytes) -> bytes:
        return data.replace(struct.pack("<I", 5_000_000), struct.pack("<I", 5))

    found = collect(packed.close(lie))
    assert taken(found) == IN_FOLDERS
    assert "cannot be unpacked" in dict(found.dropped)["mallory"]
    assert not (tmp_path / "workspace/mallory/temperature_service.py").exists()


def test_a_zip_in_a_zip_is_opened_once_and_is_one_students(tmp_path: Path) -> None:
    packed = Zip(tmp_path / "all.zip")
    inner = Zip(tmp_path / "inner.zip")
    inner.add("work.zip", b"PK\x05\x06" + bytes(18))
    inner.add("../../bob/temperature_service.py")
    data = inner.close().read_bytes()
    (tmp_path / "inner.zip").unlink()
    packed.add("mallory/work.zip", data)
    packed.add("dee.zip", data)
    packed.add("eve/work.zip", b"PK\x03\x04 and then nothing")
    found = collect(packed.close())
    result = taken(found)
    assert result.pop("mallory").startswith("mallory/work.zip.contents/")
    assert result.pop("dee").startswith("dee.zip.contents/")
    assert result.pop("eve") == "eve/work.zip", "its report says that it is no program"
    assert result == IN_FOLDERS
    left = dict(found.left)
    assert left["mallory/work.zip.contents/work.zip"] == "it belongs to none of these exercises"
    assert "../../bob/temperature_service.py" in " ".join(left)
    assert not list(tmp_path.glob("workspace/**/work.zip.contents/work.zip.contents"))
    assert (tmp_path / "workspace/bob/temperature_service.py").read_bytes() == b"pass\n"


def test_a_folder_that_is_not_ours_is_not_emptied(tmp_path: Path) -> None:
    lay_out(tmp_path / "workspace", ["precious.txt"])
    with pytest.raises(GradingError, match=r"but that already exists\. Move it away first"):
        collect(Zip(tmp_path / "all.zip").close())
    assert (tmp_path / "workspace/precious.txt").is_file()


def test_a_zip_as_large_as_a_list_of_a_million_files_is_one_students_problem(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archive, "LARGEST_OF_ONE", 100)
    lay_out(tmp_path / "in", IN_FOLDERS.values())
    lay_out(tmp_path / "in", ["mallory/work.zip"], "PK" * 51)
    found = collect(tmp_path / "in")
    assert taken(found) == {**IN_FOLDERS, "mallory": "mallory/work.zip"}  # which gets a report that it is no program
    assert dict(found.left) == {"mallory/work.zip": "it is too much: at most 0 MB are opened"}

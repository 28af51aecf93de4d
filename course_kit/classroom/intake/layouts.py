"""How learning platforms lay out what was handed in: who an entry of the folder is from, by the entry's name alone.

Platforms and instructors name these entries; what is inside of one is named by its student, and tells nothing about
anybody else. So a layout is what most entries look like, and one that looks otherwise is its own student.

- **canvas** ("Download Submissions"): `doejane_LATE_12345_67890_answer.py`, as Canvas's `content_zipper.rb` writes it:
  the name, whether it is late, Canvas's numbers of the user and of the uploaded file, and the student's name for the
  file. The student is the user number, 12345. Anonymous work is `anon_a1B2c_67890_answer.py`, or `LATE_anon_...`; of a
  group there is one user, and the group's name.
- **moodle** ("Download all submissions"): `Jane Doe_4711_assignsubmission_file_/answer.py`, or the same without the
  folder. The student is the participant's number, 4711, which differs in each assignment. Work of a group has
  the group's name and number there.
- **gradescope** ("Export Submissions"): `submission_123456/answer.py`; a file beside it says whose (`gradescope`).
- **nbgrader** (the `submitted` folder): `submitted/jane/assignment/answer.ipynb`. The student is `jane`.
- **github** (`gh classroom clone student-repos`): `assignment-submissions/assignment-jane/answer.py`. The student is
  the login, `jane`; a clone in a folder of another name gives its whole name.
- **folders**: `jane/answer.py`. The student is the folder.
- **files**: `jane.py`, or `jane_<exercise>.py`. The student is the file's name without that ending.
"""

from __future__ import annotations

import hashlib
import re
from collections import defaultdict
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from course_kit.classroom.intake.listing import FILE, FOLDER, Item
from course_kit.reader.text import NOTEBOOK, PROGRAM
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence


LAYOUTS = ("canvas", "moodle", "gradescope", "nbgrader", "github", "folders", "files")
CLONES = "-submissions"  # how the folder of all repositories of an assignment ends
_CANVAS = re.compile(
    r"(?P<name>.+?)_(?P<late>LATE_)?(?P<user>\d{1,18})_(?P<upload>\d{1,18})_(?P<file>.+)", re.DOTALL | re.ASCII
)
_CANVAS_ANONYMOUS = re.compile(
    r"(?P<late>LATE_)?(?P<user>anon_[a-zA-Z0-9]{5,20})_(?P<later>LATE_)?(?P<upload>\d{1,18})_(?P<file>.+)",
    re.DOTALL | re.ASCII,
)
_CANVAS_TYPED = re.compile(r"(?P<name>.+?)_(?P<late>LATE_)?(?P<user>\d{1,18})_(?P<file>(?:text|link)\.html)", re.ASCII)
# Canvas numbers files of one name in front of their endings, and takes a UUID for the eighth.
_CANVAS_AGAIN = re.compile(
    r"-(?:(?P<number>\d{1,9})|[0-9a-f]{8}(?:-[0-9a-f]{4}){3}-[0-9a-f]{12})(?=(?:\.[A-Za-z][A-Za-z0-9]*)+\Z)", re.ASCII
)
_MOODLE = re.compile(r"_(?:(?P<number>\d{1,18})_)?assignsubmission_(?:file|onlinetext)", re.ASCII)
_GRADESCOPE = re.compile(r"submission_(?P<number>\d{1,18})", re.ASCII)
_MOST_NUMBERS = 3  # in a sentence
_ARCHIVES = (".zip", ".tar", ".gz", ".tgz", ".bz2", ".xz", ".7z", ".rar")
_NAMELESS = "unnamed"
_MARK = 8  # hexadecimal digits that tell two apart who look the same
_MARKED = re.compile(rf"~[0-9a-f]{{{_MARK}}}\Z")  # nobody is called like somebody else with a mark
# Marks that change how, or whether, the letter before them is drawn; without one two names look the same.
_INVISIBLE = re.compile("[\u034f\u17b4\u17b5\u180b-\u180f\ufe00-\ufe0f\U000e0100-\U000e01ef\u200c\u200d]")

Key = tuple[str, str]


@dataclass(frozen=True)
class HandIn:
    """What one student has control of: a file or folder among those of the others, or one of the files in it."""

    item: Item  # where
    student: str  # their identifier, as the name has it
    name: str = ""  # their own name, where it is known
    file: str = ""  # what they called it, of a file whose name the platform has lengthened
    late: bool = False  # marked as late by the platform
    # how often it was uploaded again; of several under one name, the higher one is the newer one
    attempt: tuple[int, ...] = ()
    platform: dict[str, str] = field(default_factory=dict)  # identifiers for the way back, see `Entry.platform`
    has_assignments: bool = False  # whether the folders in it are one for each assignment
    odd: str = ""  # how it does not fit the layout; empty when it does
    download: str = ""  # the name of the download it is in, where there are several
    exercise: str = ""  # the id of the exercise that this download is of; empty where nothing says so
    inside: str = ""  # of a file in a student's folder or zip: where that is
    # of one that may be the submission for an exercise, see `candidates`: how sure that is, and when it was written
    sureness: int = 0
    changed: float = 0.0
    found: bool = False  # whether it holds what the exercise asks for
    identity: str = ""  # equal for programs that differ in comments and blanks alone
    imports: frozenset[str] = frozenset()
    is_starter: bool = False  # whether its program is one that the course gave out
    fits: bool = False  # whether it holds what is asked for, or may do without: a program that uses rclpy
    doubt: str = ""  # what in it somebody should look at
    why: str = ""  # of the one that was chosen the reason, in words
    worry: str = ""  # of that one why somebody should look at the choice; empty when there is no doubt

    @property
    def path(self) -> str:
        """From the root."""
        return self.item.path

    @property
    def problem(self) -> str:
        """Why it cannot be had; empty when nothing is known against it."""
        return self.item.problem

    @property
    def file_name(self) -> str:
        """What the student called it."""
        return (not self.inside and self.file) or self.item.name

    @property
    def folder(self) -> str:
        """The folder it lies in."""
        return self.path.rpartition("/")[0]

    def with_item(self, item: Item) -> HandIn:
        """Itself, as it was looked at, or one of the files in it."""
        return replace(self, item=item, inside=self.inside if item.path == self.path else self.inside or self.path)


def read_canvas(item: Item, _: str = "") -> HandIn | None:
    """An entry of Canvas's archive."""
    match = _CANVAS_ANONYMOUS.fullmatch(item.name) or _CANVAS.fullmatch(item.name) or _CANVAS_TYPED.fullmatch(item.name)
    if match is None:
        return None
    found = match.groupdict()
    again = _CANVAS_AGAIN.search(match["file"])
    upload = found.get("upload") or "0"
    user = match["user"]
    return HandIn(
        item,
        student=user,
        name=found.get("name") or "",
        file=_CANVAS_AGAIN.sub("", match["file"]),
        late=bool(match["late"] or found.get("later")),
        attempt=(int(upload), int(again["number"] or 0) if again else 0),
        platform={"canvas_user": user, "canvas_submission": upload} if "name" in found else {},
    )


def read_moodle(item: Item, _: str = "") -> HandIn | None:
    """An entry of Moodle's archive."""
    found = list(_MOODLE.finditer(item.name))
    if not found or not found[0].start():
        return None
    mark = found[0]
    rest = item.name[mark.end() :]
    if len(found) > 1:
        numbers = " or ".join(match["number"] or "of no number" for match in found[:_MOST_NUMBERS])
        return HandIn(item, item.name, odd=f"its name can also be read as that of participant {numbers}")
    if item.kind == FOLDER and rest not in ("", "_"):
        return None
    number = mark["number"]
    name, file = item.name[: mark.start()], rest.removeprefix("_")
    if number is None:  # whoever is in no group, where groups hand in
        return HandIn(item, name, name, file, platform={"group": name})
    return HandIn(item, number, name, file, platform={"moodle_participant": number})


def read_gradescope(item: Item, _: str = "") -> HandIn | None:
    """A submission of Gradescope's export; whose it is stands in the file beside it."""
    match = _GRADESCOPE.fullmatch(item.name)
    if match is None or item.kind != FOLDER:
        return None
    return HandIn(item, item.name, platform={"gradescope_submission": match["number"]})


def read_nbgrader(item: Item, _: str = "") -> HandIn | None:
    """A student's folder of nbgrader, with a folder for each assignment."""
    return HandIn(item, item.name, has_assignments=True) if item.kind == FOLDER else None


def read_folders(item: Item, _: str = "") -> HandIn | None:
    """A folder that is named after the student."""
    return HandIn(item, item.name) if item.kind == FOLDER else None


def read_github(item: Item, slug: str = "") -> HandIn | None:
    """A repository that GitHub Classroom's command has cloned, of the assignment `slug` where it is known."""
    if item.kind != FOLDER:
        return None
    login = item.name.removeprefix(f"{slug}-") if slug else item.name
    odd = f"its name does not begin with {slug}-" if slug and login == item.name else ""
    return HandIn(item, login, platform={"login": login}, odd=odd)


def read_files(item: Item, _: str = "") -> HandIn | None:
    """A file that is named after the student; the exercise's name at its end is taken off by `students`."""
    return HandIn(item, _stem(item)) if item.kind != FOLDER else None


def _stem(item: Item) -> str:
    stem, _, ending = item.name.rpartition(".")
    if item.is_program and f".{ending.lower()}" not in (PROGRAM, NOTEBOOK):  # jane.py.txt
        stem = stem.rpartition(".")[0] or stem
    return stem or item.name


_READERS: dict[str, Callable[[Item, str], HandIn | None]] = {
    "canvas": read_canvas,
    "moodle": read_moodle,
    "gradescope": read_gradescope,
    "nbgrader": read_nbgrader,
    "github": read_github,
    "folders": read_folders,
    "files": read_files,
}


def read_unit(layout: str, item: Item, slug: str = "") -> HandIn | None:
    """Who an entry is from."""
    return _READERS[layout](item, slug)


def mark_groups(units: Sequence[HandIn]) -> Sequence[HandIn]:
    """Entries of a download; where one of Moodle's has no number, groups have handed in, and numbers are groups'."""
    if not any("group" in unit.platform for unit in units):
        return units
    return [
        replace(unit, platform={"group": unit.name}) if "moodle_participant" in unit.platform else unit
        for unit in units
    ]


def read_stray(layout: str, item: Item) -> HandIn | None:
    """Who an entry is from that does not follow the layout of the others; None where it is nobody's work."""
    if item.kind == FILE and not may_be_handed_in(item):
        return None
    student = item.name if item.kind == FOLDER else _stem(item)
    return HandIn(item, student, odd=f"its name does not follow the layout '{layout}'")


def may_be_handed_in(item: Item) -> bool:
    """Whether a file between the students' entries looks like somebody's work, not like the instructor's notes."""
    return item.is_program or item.name.lower().endswith(_ARCHIVES)


def most_fit(items: Sequence[Item], fits: Callable[[Item], object]) -> bool:
    """Whether more than half of some entries are of a kind; of none at all there is no most."""
    return 2 * sum(bool(fits(item)) for item in items) > len(items)


def group_by_student(units: Iterable[HandIn], exercises: Sequence[str]) -> dict[str, list[HandIn]]:
    """Each student's entries, by a name that is printable and nobody else's."""
    own: dict[Key, list[HandIn]] = defaultdict(list)
    for unit in _without_doubtful([_without_exercise(unit, exercises) for unit in units]):
        own[_key(unit)].append(unit)
    names = _names(own)
    return {names[key]: own[key] for key in sorted(own, key=names.__getitem__)}


def join_downloads(units: Sequence[HandIn], layout: str, exercises: int) -> list[HandIn]:
    """Entries of several downloads of one class, so that what is one student's has one identifier."""
    numbers: dict[str, dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
    for unit in units:
        if not unit.odd:
            numbers[unit.name][unit.download].add(unit.student)
    if layout != "moodle" or _is_of_one_assignment(numbers.values(), units, exercises):
        return list(units)
    found = []
    for unit in units:
        if unit.odd:
            found.append(unit)
        elif all(len(of_one) == 1 for of_one in numbers[unit.name].values()):
            found.append(replace(unit, student=unit.name))
        else:
            student = f"{unit.name} {unit.student} of {unit.download}"
            odd = f"'{unit.name}' has several participant numbers, so nothing joins them with other downloads"
            found.append(replace(unit, student=student, odd=odd))
    return found


def _is_of_one_assignment(numbers: Iterable[Mapping[str, set[str]]], units: Sequence[HandIn], exercises: int) -> bool:
    """Whether all who are in several downloads have the same numbers there, and somebody is or one exercise was set."""
    twice = [list(of_name.values()) for of_name in numbers if len(of_name) > 1]
    agree = all(numbers == of_name[0] for of_name in twice for numbers in of_name)
    return agree and len({unit.exercise for unit in units}) == 1 and (bool(twice) or exercises == 1)


def _key(unit: HandIn) -> Key:
    return (f"{unit.item.kind == FOLDER} {unit.name}" if unit.odd else "", unit.student)


def _without_exercise(unit: HandIn, exercises: Sequence[str]) -> HandIn:
    """`jane_EXERCISE.py` is jane's; a file that is called like the exercise alone stays as it is."""
    if unit.item.kind == FOLDER:
        return unit
    for exercise in exercises:
        student = unit.student.removesuffix(exercise).rstrip(" _.-")
        if unit.student.endswith(exercise) and student:
            return replace(unit, student=student)
    return unit


def _without_doubtful(units: list[HandIn]) -> list[HandIn]:
    """Where a platform's number stands beside two people's names, it is no one's number."""
    names: dict[str, set[str]] = defaultdict(set)
    for unit in units:
        if not unit.odd:
            names[unit.student].add(unit.name)
    found = []
    for unit in units:
        doubtful = not unit.odd and len(names[unit.student]) > 1 and "email" not in unit.platform
        odd = f"the number {unit.student} also belongs to another name"
        found.append(replace(unit, student=f"{unit.student} {unit.name}", platform={}, odd=odd) if doubtful else unit)
    return found


def _names(keys: Iterable[Key]) -> dict[Key, str]:
    """A name for each: their own where it can be, else with a mark that depends on nothing but the name itself."""
    alike: dict[str, list[Key]] = defaultdict(list)
    for key in sorted(keys):  # entries that fit come first
        alike[_INVISIBLE.sub("", _clean(key))].append(key)
    names: dict[Key, str] = {}
    for look, group in alike.items():
        fitting = (key for key in group if len(group) == 1 or key[1] == look)
        plain = None if _MARKED.search(look) else next(fitting, None)
        names.update((key, _clean(key) if key == plain else f"{_clean(key)}~{_mark(key)}") for key in group)
    return names


def _mark(key: Key) -> str:
    return hashlib.sha256("\0".join(key).encode(errors="surrogatepass")).hexdigest()[:_MARK]


def _clean(key: Key) -> str:
    return one_line(key[1]) or _NAMELESS

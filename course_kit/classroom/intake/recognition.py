"""Where in a download the students begin, and which layout most of their entries have, by names alone.

They begin below the folders that a platform, a browser or a Mac has put around them. Students and such folders must
never be mistaken for one another, so where two are possible the command asks for --layout.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_kit.classroom.intake import layouts
from course_kit.classroom.intake.gradescope_export import METADATA
from course_kit.classroom.intake.layouts import CLONES, most_fit
from course_kit.classroom.intake.listing import FOLDER, why_a_tools
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from course_kit.classroom.intake.listing import Item, LeftOut, Listing

TITLES = {"canvas": "Canvas", "moodle": "Moodle", "gradescope": "Gradescope"}  # whose names no student would choose
SUBMITTED = "submitted"
_ENOUGH = 200  # entries of a folder, to see what they look like
_FEW = 20  # folders of a student that are looked into
AUTO = "auto"
_NBGRADERS_OWN = frozenset({"gradebook.db", "nbgrader_config.py", "source", "release", "autograded", "feedback"})
_FEWEST_OF_NBGRADER = 2  # of these beside `submitted`
_DEEPEST = 2  # folders around the students
_FEWEST = 3  # folders that hold a starter's name, to be students and not parts of one student's work
_DEEPEST_STARTER = 2  # folders below a student's
_MACS = "__MACOSX"
_EXPORT = re.compile(r"assignment_\d{1,18}_export(?:[ _-]?\(?\d{1,3}\)?)?", re.ASCII)
_AGAIN = re.compile(r"[ _-]?\(?\d{1,3}\)?\Z")  # `week3 (1)`, a second download


def list_entries(listing: Listing, folder: str, left: LeftOut | None = None, most: int | None = None) -> list[Item]:
    """What lies in a folder but for what tools have left there; for `left` those too."""
    found = []
    for item in listing.children(folder, most):
        hidden = item.kind != FOLDER and item.name.startswith(".") and not item.is_program
        if reason := why_a_tools(item) or ("a hidden file" if hidden else ""):
            if left is not None:
                left.append((item.path, reason))
        else:
            found.append(item)
    return found


def look_inside(listing: Listing, item: Item) -> list[Item]:
    """Entries of a folder, enough to see what they look like; none where it is none, or cannot be looked into."""
    if item.kind != FOLDER:
        return []
    try:
        return list_entries(listing, item.path, most=_ENOUGH)
    except OSError:
        return []


def looks_like(layout: str, items: list[Item]) -> bool:
    """Whether most entries follow a platform's layout; an instructor's notes between them do not count."""
    fitting = [item for item in items if layouts.read_unit(layout, item)]
    return 2 * len(fitting) > len({*fitting, *likely_entries(items)})


def likely_entries(items: list[Item]) -> list[Item]:
    """The entries that may be somebody's work, and not an instructor's notes."""
    return [item for item in items if item.kind == FOLDER or layouts.may_be_handed_in(item)]


def recognise_layout(listing: Listing, items: list[Item], called: str) -> str:
    """The layout of most entries."""
    if called == SUBMITTED:
        return "nbgrader"
    for layout in TITLES:
        if looks_like(layout, items):
            return layout
    if most_fit(items, lambda item: _has_timestamp(listing, item)):
        return "nbgrader"
    clones = [item for item in items if holds_clones(listing, item) or _is_clone(listing, item)]
    if assignment_slug(items, called) or 2 * len(clones) > len(items):
        return "github"
    return "files" if most_fit(likely_entries(items) or items, lambda item: item.kind != FOLDER) else "folders"


def _has_timestamp(listing: Listing, student: Item) -> bool:
    """Whether nbgrader has noted the time of an assignment."""
    return any(
        item.name == "timestamp.txt"
        for assignment in look_inside(listing, student)[:_FEW]
        for item in look_inside(listing, assignment)
    )


def _is_clone(listing: Listing, item: Item) -> bool:
    if item.kind != FOLDER:
        return False
    try:
        return any(child.name == ".git" for child in listing.children(item.path, _ENOUGH))
    except OSError:
        return False


def holds_clones(listing: Listing, item: Item) -> bool:
    """Whether a folder is called after an assignment, and so are the repositories in it."""
    return item.kind == FOLDER and bool(assignment_slug(look_inside(listing, item), item.name))


def assignment_slug(items: list[Item], called: str) -> str:
    """The assignment's name if a folder is called after it, and so are the repositories in it."""
    name = called.removesuffix(CLONES)
    belongs = name and name != called and most_fit(items, lambda item: item.name.startswith(f"{name}-"))
    return name if belongs else ""


@dataclass(frozen=True)
class Download:
    """A folder or an archive, and what is known of it."""

    listing: Listing  # what is in it
    called: str  # the name of the folder, or of the archive without its ending
    packed: bool = False  # whether it is an archive
    starters: frozenset[str] = field(default_factory=frozenset)  # the file names of starters and notebooks


def enter_download(download: Download, layout: str) -> tuple[str, str]:
    """Go into the folders around the students."""
    listing, called, folder = download.listing, download.called, ""
    for _ in range(_DEEPEST):
        items = list_entries(listing, folder)
        some = likely_entries(items)
        lone = some[0] if len(some) == 1 and some[0].kind == FOLDER else None
        if submitted := _find_submitted_folder(items, layout):
            return submitted.path, SUBMITTED
        if lone and layout in (AUTO, "github") and holds_clones(listing, lone):
            return lone.path, lone.name
        if layout != AUTO and (lone is None or layout not in TITLES or layouts.read_unit(layout, lone)):
            return folder, called
        if layout == AUTO and not (lone and _is_around(download, folder, called, lone)):
            _require_a_top(listing, items, called)
            _require_students(download, lone, called)
            return folder, called
        if lone is not None:
            folder, called = lone.path, lone.name
    return folder, called


def _find_submitted_folder(items: list[Item], layout: str) -> Item | None:
    """The folder in which nbgrader keeps what was handed in."""
    found = next((item for item in items if item.name == SUBMITTED and item.kind == FOLDER), None)
    others = {item.name for item in items} & _NBGRADERS_OWN
    looks_so = len(likely_entries(items)) == 1 or len(others) >= _FEWEST_OF_NBGRADER
    return found if layout == "nbgrader" or (layout == AUTO and looks_so) else None


def _is_around(download: Download, folder: str, called: str, lone: Item) -> bool:
    """Whether a lone folder was put around the students, and is not a student's."""
    within = look_inside(download.listing, lone)
    if looks_like("gradescope", within) and any(item.name == METADATA for item in within):
        return download.packed or bool(_EXPORT.fullmatch(lone.name))
    if not download.packed:
        return False
    named = _plain(lone.name) == _plain(called) or any(
        item.name == _MACS for item in download.listing.children(folder, _ENOUGH)
    )
    known = _find_submitted_folder(within, AUTO) or any(looks_like(layout, within) for layout in TITLES)
    return (named and bool(known)) or _are_students(download, within, _FEWEST - named)


def _plain(name: str) -> str:
    return _AGAIN.sub("", name).strip().lower()


def _are_students(download: Download, items: list[Item], fewest: int) -> bool:
    """Whether most entries hold, or are called like, what was set: parts of one student's work do not."""
    some = likely_entries(items)
    stems = tuple(name.rpartition(".")[0] for name in download.starters)

    def is_one(item: Item) -> bool:
        if item.kind == FOLDER:
            return _holds_starter(download, item, _DEEPEST_STARTER)
        stem = item.name.partition(".")[0]
        return item.is_zip or (stem.endswith(stems) and stem not in stems)

    return len(some) >= fewest and most_fit(some, is_one)


def _holds_starter(download: Download, folder: Item, depth: int) -> bool:
    found = look_inside(download.listing, folder)
    if any(item.kind != FOLDER and item.name in download.starters for item in found):
        return True
    return depth > 0 and any(
        _holds_starter(download, item, depth - 1) for item in found[:_ENOUGH] if item.kind == FOLDER
    )


def _require_students(download: Download, lone: Item | None, called: str) -> None:
    """See that a whole class is not taken for one student, whose other files would be left."""
    if lone and _are_students(download, look_inside(download.listing, lone), _FEWEST):
        raise GradingError(
            f"All of {called} is in one folder, '{lone.name}', which seems to hold the students. If so, name that "
            f"folder instead. If '{lone.name}' is a student, add --layout folders."
        )


def _require_a_top(listing: Listing, items: list[Item], called: str) -> None:
    """See that students and folders around them cannot be mistaken for one another."""
    for layout, title in TITLES.items():
        if looks_like(layout, items):
            return
        around = [item for item in items if looks_like(layout, look_inside(listing, item))]
        if not around or 2 * len(around) <= len(items):
            continue
        if len(items) == 1:
            raise GradingError(
                f"All of {called} is in one folder, '{items[0].name}', and what is in that is named as {title} names "
                f"students' work. If '{items[0].name}' is a student, add --layout folders. If it holds the students, "
                f"add --layout {layout}."
            )
        raise GradingError(
            f"The folders in {called} look like several downloads from {title}, '{around[0].name}' and others. Name "
            "each of them instead of the folder around them. If they are students, add --layout folders."
        )

"""Where in a download the students begin: below the folders that a platform, a browser or a Mac has put around them.

Students and such folders must never be mistaken for one another, so what cannot be told apart is asked for.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_kit.classroom.intake import layouts
from course_kit.classroom.intake.gradescope_export import METADATA
from course_kit.classroom.intake.listing import FOLDER
from course_kit.classroom.intake.recognition import SUBMITTED, TITLES, entries, holds_clones, inside, likely, looks_like
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from course_kit.classroom.intake.listing import Item, Listing

AUTO = "auto"
_NBGRADERS_OWN = frozenset({"gradebook.db", "nbgrader_config.py", "source", "release", "autograded", "feedback"})
_FEWEST_OF_NBGRADER = 2  # of these beside `submitted`
_DEEPEST = 3  # folders around the students
_FEWEST = 3  # folders that hold a starter's name, to be students and not parts of one student's work
_DEEPEST_STARTER = 2  # folders below a student's
_MACS = "__MACOSX"
_ENOUGH = 200  # entries of a folder that are looked at
_EXPORT = re.compile(r"assignment_\d{1,18}_export(?:[ _-]?\(?\d{1,3}\)?)?", re.ASCII)
_AGAIN = re.compile(r"[ _-]?\(?\d{1,3}\)?\Z")  # `week3 (1)`, a second download


@dataclass(frozen=True)
class Download:
    """A folder or an archive, and what is known of it."""

    listing: Listing  # what is in it
    called: str  # the name of the folder, or of the archive without its ending
    packed: bool = False  # whether it is an archive
    starters: frozenset[str] = field(default_factory=frozenset)  # the file names of starters and notebooks


def enter(download: Download, layout: str) -> tuple[str, str]:
    """Go into the folders around the students."""
    listing, called, folder = download.listing, download.called, ""
    for _ in range(_DEEPEST):
        items = entries(listing, folder)
        some = likely(items)
        lone = some[0] if len(some) == 1 and some[0].kind == FOLDER else None
        if submitted := _submitted(items, layout):
            return submitted.path, SUBMITTED
        if lone and layout in (AUTO, "github") and holds_clones(listing, lone):
            return lone.path, lone.name
        if layout != AUTO and (lone is None or layout not in TITLES or layouts.read(layout, lone)):
            return folder, called
        if layout == AUTO and not (lone and _is_around(download, folder, called, lone)):
            _require_a_top(listing, items, called)
            _require_students(download, lone, called)
            return folder, called
        if lone is not None:
            folder, called = lone.path, lone.name
    return folder, called


def _submitted(items: list[Item], layout: str) -> Item | None:
    """The folder in which nbgrader keeps what was handed in."""
    found = next((item for item in items if item.name == SUBMITTED and item.kind == FOLDER), None)
    others = {item.name for item in items} & _NBGRADERS_OWN
    sure = layout == "nbgrader" or (layout == AUTO and (len(likely(items)) == 1 or len(others) >= _FEWEST_OF_NBGRADER))
    return found if sure else None


def _is_around(download: Download, folder: str, called: str, lone: Item) -> bool:
    """Whether a lone folder was put around the students, and is not a student's."""
    within = inside(download.listing, lone)
    if looks_like("gradescope", within) and any(item.name == METADATA for item in within):
        return download.packed or bool(_EXPORT.fullmatch(lone.name))
    if not download.packed:
        return False
    named = _plain(lone.name) == _plain(called) or any(
        item.name == _MACS for item in download.listing.children(folder, _ENOUGH)
    )
    known = _submitted(within, AUTO) or any(looks_like(layout, within) for layout in TITLES)
    return (named and bool(known)) or _are_students(download, within, _FEWEST - named)


def _plain(name: str) -> str:
    return _AGAIN.sub("", name).strip().lower()


def _are_students(download: Download, items: list[Item], fewest: int) -> bool:
    """Whether most entries hold, or are called like, what was set: parts of one student's work do not."""
    some = likely(items)
    stems = tuple(name.rpartition(".")[0] for name in download.starters)

    def is_one(item: Item) -> bool:
        if item.kind == FOLDER:
            return _holds_starter(download, item, _DEEPEST_STARTER)
        stem = item.name.partition(".")[0]
        return item.is_zip or (stem.endswith(stems) and stem not in stems)

    return len(some) >= fewest and layouts.most(some, is_one)


def _holds_starter(download: Download, folder: Item, depth: int) -> bool:
    found = inside(download.listing, folder)
    if any(item.kind != FOLDER and item.name in download.starters for item in found):
        return True
    return depth > 0 and any(
        _holds_starter(download, item, depth - 1) for item in found[:_ENOUGH] if item.kind == FOLDER
    )


def _require_students(download: Download, lone: Item | None, called: str) -> None:
    """See that a whole class is not taken for one student, whose other files would be left."""
    if lone and _are_students(download, inside(download.listing, lone), _FEWEST):
        raise GradingError(
            f"All of {called} lies in one folder, '{lone.name}', which seems to hold the students. If so, name that "
            f"folder instead. If '{lone.name}' is a student, add --layout folders."
        )


def _require_a_top(listing: Listing, items: list[Item], called: str) -> None:
    """See that students and folders around them cannot be mistaken for one another."""
    for layout, title in TITLES.items():
        if looks_like(layout, items):
            return
        around = [item for item in items if looks_like(layout, inside(listing, item))]
        if not around or 2 * len(around) <= len(items):
            continue
        if len(items) == 1:
            raise GradingError(
                f"All of {called} lies in one folder, '{items[0].name}', and what is in that is named as {title} names "
                f"students' work. If '{items[0].name}' is a student, add --layout folders. If it holds the students, "
                f"add --layout {layout}."
            )
        raise GradingError(
            f"The folders in {called} look like several downloads from {title}, '{around[0].name}' and others. Name "
            "each of them instead of the folder around them. If they are students, add --layout folders."
        )

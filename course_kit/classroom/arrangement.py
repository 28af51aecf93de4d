"""Where in a folder or archive the students begin, and which layout their entries have: by a majority, never by one.

Only what lies beside the students counts, so that nothing inside of one student's work says who the others are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.classroom import layouts
from course_kit.classroom.layouts import CLONES, most
from course_kit.classroom.listing import FOLDER, of_a_tool
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.classroom.layouts import Unit
    from course_kit.classroom.listing import Item, Left, Listing

AUTO = "auto"
_TITLES = {"canvas": "Canvas", "moodle": "Moodle"}
_SUBMITTED = "submitted"
_NBGRADERS_OWN = frozenset({"gradebook.db", "nbgrader_config.py", "source", "release", "autograded", "feedback"})
_FEWEST_OF_NBGRADER = 2  # of these beside `submitted`
_DEEPEST = 3  # folders around the students
_ENOUGH = 200  # entries of a folder, to see what they look like
_FEW = 20  # folders of a student that are looked into


@dataclass(frozen=True)
class Arrangement:
    """Where the students are.

    Attributes:
        layout: one of `layouts.LAYOUTS`.
        units: what each has control of; one student may have several.
        left: path and reason of what lies beside them.
    """

    layout: str
    units: tuple[Unit, ...]
    left: tuple[tuple[str, str], ...]


def arrange(listing: Listing, layout: str, called: str) -> Arrangement:
    """Find the students' entries.

    Args:
        listing: the folder or archive.
        layout: one of `layouts.LAYOUTS`, or AUTO to recognise it.
        called: the name of the folder, or of the archive without its ending.

    Raises:
        GradingError: there is no such layout, the folder cannot be read, or nobody can tell students from folders
            around them.
    """
    if layout not in (AUTO, *layouts.LAYOUTS):
        raise GradingError(f"There is no layout '{layout}'. Choose one of: {AUTO}, {', '.join(layouts.LAYOUTS)}.")
    left: Left = []
    folder, called = _enter(listing, layout, called)
    items = _entries(listing, folder, left)
    found = _recognise(listing, items, called) if layout == AUTO else layout
    units: list[Unit] = []
    for item, unit in _read_all(listing, found, items, called, left):
        if unit is None:
            left.append((item.path, f"its name does not follow the layout '{found}'"))
        else:
            units.append(unit)
    return Arrangement(found, tuple(units), tuple(left))


def _entries(listing: Listing, folder: str, left: Left | None = None, most: int | None = None) -> list[Item]:
    """What lies in a folder but for what tools have left there; for `left` those too."""
    entries = []
    for item in listing.children(folder, most):
        hidden = item.kind != FOLDER and item.name.startswith(".") and not item.is_program
        if reason := of_a_tool(item) or ("a hidden file" if hidden else ""):
            if left is not None:
                left.append((item.path, reason))
        else:
            entries.append(item)
    return entries


def _inside(listing: Listing, item: Item) -> list[Item]:
    """Entries of a folder, enough to see what they look like; none where it is none, or cannot be looked into."""
    if item.kind != FOLDER:
        return []
    try:
        return _entries(listing, item.path, most=_ENOUGH)
    except OSError:
        return []


def _enter(listing: Listing, layout: str, called: str) -> tuple[str, str]:
    """Go into the folders around the students; returns the path and the name of the innermost."""
    folder = ""
    for _ in range(_DEEPEST):
        items = _entries(listing, folder)
        names = {item.name for item in items}
        likely = _likely(items)
        lone = likely[0] if len(likely) == 1 and likely[0].kind == FOLDER else None
        submitted = next((item for item in items if item.name == _SUBMITTED and item.kind == FOLDER), None)
        if submitted and (
            layout == "nbgrader" or (layout == AUTO and (lone or len(names & _NBGRADERS_OWN) >= _FEWEST_OF_NBGRADER))
        ):
            return submitted.path, _SUBMITTED
        if lone and layout in (AUTO, "github") and _holds_clones(listing, lone):
            return lone.path, lone.name
        if layout == AUTO:
            _require_a_top(listing, items, called)
        if lone is None or layout not in _TITLES or layouts.read(layout, lone):
            return folder, called
        folder, called = lone.path, lone.name
    return folder, called


def _require_a_top(listing: Listing, items: list[Item], called: str) -> None:
    """See that students and folders around them cannot be mistaken for one another.

    Whoever is alone in a folder could name files in it like Moodle names other students'.
    """
    for layout, title in _TITLES.items():
        if _looks_like(layout, items):
            return
        around = [item for item in items if _looks_like(layout, _inside(listing, item))]
        if not around or 2 * len(around) <= len(items):
            continue
        if len(items) == 1:
            raise GradingError(
                f"All of {called} lies in one folder, '{items[0].name}', and what is in that is named as {title} names "
                f"students' work. If '{items[0].name}' is a student, add --layout folders. If it holds the students, "
                f"add --layout {layout}."
            )
        raise GradingError(
            f"The folders in {called} look like several downloads from {title}, '{around[0].name}' and others. Grade "
            "each of them by itself. If they are students, add --layout folders."
        )


def _looks_like(layout: str, items: list[Item]) -> bool:
    """Whether most entries follow a platform's layout; an instructor's notes between them do not count."""
    fitting = [item for item in items if layouts.read(layout, item)]
    return 2 * len(fitting) > len({*fitting, *_likely(items)})


def _likely(items: list[Item]) -> list[Item]:
    return [item for item in items if item.kind == FOLDER or layouts.may_be_handed_in(item)]


def _recognise(listing: Listing, items: list[Item], called: str) -> str:
    """The layout of most entries."""
    if called == _SUBMITTED:
        return "nbgrader"
    for layout in _TITLES:
        if _looks_like(layout, items):
            return layout
    if most(items, lambda item: _has_timestamp(listing, item)):
        return "nbgrader"
    if _slug(items, called) or most(items, lambda item: _holds_clones(listing, item) or _is_clone(listing, item)):
        return "github"
    return "files" if most(_likely(items) or items, lambda item: item.kind != FOLDER) else "folders"


def _has_timestamp(listing: Listing, student: Item) -> bool:
    """Whether nbgrader has noted the time of an assignment."""
    return any(
        item.name == "timestamp.txt"
        for assignment in _inside(listing, student)[:_FEW]
        for item in _inside(listing, assignment)
    )


def _is_clone(listing: Listing, item: Item) -> bool:
    if item.kind != FOLDER:
        return False
    try:
        return any(one.name == ".git" for one in listing.children(item.path, _ENOUGH))
    except OSError:
        return False


def _holds_clones(listing: Listing, item: Item) -> bool:
    return item.kind == FOLDER and bool(_slug(_inside(listing, item), item.name))


def _slug(items: list[Item], called: str) -> str:
    """The assignment's name if a folder is called after it, and so are the repositories in it."""
    slug = called.removesuffix(CLONES)
    belongs = slug and slug != called and most(items, lambda item: item.name.startswith(f"{slug}-"))
    return slug if belongs else ""


def _read_all(
    listing: Listing, layout: str, items: list[Item], called: str, left: Left
) -> Iterator[tuple[Item, Unit | None]]:
    if layout == "github" and most(items, lambda item: _holds_clones(listing, item)):
        for item in items:
            if _holds_clones(listing, item):
                slug = item.name.removesuffix(CLONES)
                for clone in _entries(listing, item.path, left):
                    yield clone, layouts.read(layout, clone, slug) or layouts.read_stray(layout, clone)
            else:
                yield item, layouts.read_stray(layout, item)
        return
    slug = _slug(items, called) if layout == "github" else ""
    for item in items:
        yield item, layouts.read(layout, item, slug) or layouts.read_stray(layout, item)

"""What the entries of a folder look like, by names alone: which layout most of them have."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.classroom.intake import layouts
from course_kit.classroom.intake.layouts import CLONES, most
from course_kit.classroom.intake.listing import FOLDER, of_a_tool

if TYPE_CHECKING:
    from course_kit.classroom.intake.listing import Item, Left, Listing

TITLES = {"canvas": "Canvas", "moodle": "Moodle", "gradescope": "Gradescope"}  # whose names no student would choose
SUBMITTED = "submitted"
_ENOUGH = 200  # entries of a folder, to see what they look like
_FEW = 20  # folders of a student that are looked into


def entries(listing: Listing, folder: str, left: Left | None = None, most: int | None = None) -> list[Item]:
    """What lies in a folder but for what tools have left there; for `left` those too."""
    found = []
    for item in listing.children(folder, most):
        hidden = item.kind != FOLDER and item.name.startswith(".") and not item.is_program
        if reason := of_a_tool(item) or ("a hidden file" if hidden else ""):
            if left is not None:
                left.append((item.path, reason))
        else:
            found.append(item)
    return found


def inside(listing: Listing, item: Item) -> list[Item]:
    """Entries of a folder, enough to see what they look like; none where it is none, or cannot be looked into."""
    if item.kind != FOLDER:
        return []
    try:
        return entries(listing, item.path, most=_ENOUGH)
    except OSError:
        return []


def looks_like(layout: str, items: list[Item]) -> bool:
    """Whether most entries follow a platform's layout; an instructor's notes between them do not count."""
    fitting = [item for item in items if layouts.read(layout, item)]
    return 2 * len(fitting) > len({*fitting, *likely(items)})


def likely(items: list[Item]) -> list[Item]:
    """The entries that may be somebody's work, and not an instructor's notes."""
    return [item for item in items if item.kind == FOLDER or layouts.may_be_handed_in(item)]


def recognise(listing: Listing, items: list[Item], called: str) -> str:
    """The layout of most entries."""
    if called == SUBMITTED:
        return "nbgrader"
    for layout in TITLES:
        if looks_like(layout, items):
            return layout
    if most(items, lambda item: _has_timestamp(listing, item)):
        return "nbgrader"
    if slug(items, called) or most(items, lambda item: holds_clones(listing, item) or _is_clone(listing, item)):
        return "github"
    return "files" if most(likely(items) or items, lambda item: item.kind != FOLDER) else "folders"


def _has_timestamp(listing: Listing, student: Item) -> bool:
    """Whether nbgrader has noted the time of an assignment."""
    return any(
        item.name == "timestamp.txt"
        for assignment in inside(listing, student)[:_FEW]
        for item in inside(listing, assignment)
    )


def _is_clone(listing: Listing, item: Item) -> bool:
    if item.kind != FOLDER:
        return False
    try:
        return any(one.name == ".git" for one in listing.children(item.path, _ENOUGH))
    except OSError:
        return False


def holds_clones(listing: Listing, item: Item) -> bool:
    """Whether a folder is called after an assignment, and so are the repositories in it."""
    return item.kind == FOLDER and bool(slug(inside(listing, item), item.name))


def slug(items: list[Item], called: str) -> str:
    """The assignment's name if a folder is called after it, and so are the repositories in it."""
    name = called.removesuffix(CLONES)
    belongs = name and name != called and most(items, lambda item: item.name.startswith(f"{name}-"))
    return name if belongs else ""

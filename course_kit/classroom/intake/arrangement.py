"""Where in a folder or archive the students begin, and which layout their entries have: by a majority, never by one.

Only what lies beside the students counts, so that nothing inside of one student's work says who the others are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.classroom.intake import layouts, recognition
from course_kit.classroom.intake.gradescope_export import METADATA
from course_kit.classroom.intake.layouts import CLONES, most
from course_kit.classroom.intake.listing import FILE
from course_kit.classroom.intake.recognition import entries, holds_clones
from course_kit.classroom.intake.wrappers import AUTO, enter
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.classroom.intake.layouts import Unit
    from course_kit.classroom.intake.listing import Item, Left, Listing
    from course_kit.classroom.intake.wrappers import Download


@dataclass(frozen=True)
class Arrangement:
    """Where the students are."""

    layout: str  # one of `layouts.LAYOUTS`
    units: tuple[Unit, ...]  # what each has control of; one student may have several
    left: tuple[tuple[str, str], ...]  # path and reason of what lies beside them
    metadata: Item | None = None  # Gradescope's file that says whose each entry is


def arrange(download: Download, layout: str) -> Arrangement:
    """Find the students' entries."""
    if layout not in (AUTO, *layouts.LAYOUTS):
        raise GradingError(f"There is no layout '{layout}'. Choose one of: {AUTO}, {', '.join(layouts.LAYOUTS)}.")
    left: Left = []
    listing = download.listing
    folder, called = enter(download, layout)
    items = entries(listing, folder, left)
    found = recognition.recognise(listing, items, called) if layout == AUTO else layout
    is_metadata = [item for item in items if found == "gradescope" and item.name == METADATA and item.kind == FILE]
    units: list[Unit] = []
    for item, unit in _read_all(listing, found, [item for item in items if item not in is_metadata], called, left):
        if unit is None:
            left.append((item.path, f"its name does not follow the layout '{found}'"))
        else:
            units.append(unit)
    return Arrangement(found, tuple(layouts.of_groups(units)), tuple(left), next(iter(is_metadata), None))


def _read_all(
    listing: Listing, layout: str, items: list[Item], called: str, left: Left
) -> Iterator[tuple[Item, Unit | None]]:
    if layout == "github" and most(items, lambda item: holds_clones(listing, item)):
        for item in items:
            if holds_clones(listing, item):
                slug = item.name.removesuffix(CLONES)
                for clone in entries(listing, item.path, left):
                    yield clone, layouts.read(layout, clone, slug) or layouts.read_stray(layout, clone)
            else:
                yield item, layouts.read_stray(layout, item)
        return
    slug = recognition.slug(items, called) if layout == "github" else ""
    for item in items:
        yield item, layouts.read(layout, item, slug) or layouts.read_stray(layout, item)

"""What an instructor hands over: a folder, a zip, several of them, or a folder with a zip for each assignment."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom.intake import gradescope_export, layouts, listing, recognition, students
from course_kit.classroom.intake.archive import NAMES_OF_ONE, Archive, make_empty
from course_kit.classroom.intake.combined_listing import CopiedFolder, Several, moved
from course_kit.classroom.intake.gradescope_export import METADATA
from course_kit.classroom.intake.layouts import CLONES, most
from course_kit.classroom.intake.listing import FILE
from course_kit.classroom.intake.recognition import entries, holds_clones
from course_kit.classroom.intake.wrappers import AUTO, Download, enter
from course_kit.grading.errors import GradingError
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from contextlib import ExitStack
    from pathlib import Path

    from course_kit.classroom.intake.layouts import Unit
    from course_kit.classroom.intake.listing import Item, Left, Listing
    from course_kit.grading.exercise import Exercise


@dataclass(frozen=True)
class Opened:
    """What was handed in, and whose each entry is."""

    root: Path  # the folder below which each file lies once it is fetched
    listing: Listing  # everything
    is_copy: bool  # whether the root is a folder of ours, in which more may be unpacked
    layout: str  # the name of the layout; several, with commas, where downloads have different ones
    units: tuple[Unit, ...]  # what each student has control of
    left: tuple[tuple[str, str], ...]  # path and reason of what lies beside them
    lost: tuple[tuple[str, str], ...]  # of these what may be somebody's only file


def open_all(
    paths: Sequence[Path], workspace: Path, exercises: Sequence[Exercise], layout: str, stack: ExitStack
) -> Opened:
    """Open what was handed over and find the students' entries."""
    paths = [one for path in paths for one in _downloads(path, exercises, layout)]
    if len(paths) > 1:
        return _several(paths, workspace, exercises, layout, stack)
    [path] = paths
    download = _open(path, workspace, exercises, stack, copied=False)
    opened = _opened(download, _arranged(path, download, layout), workspace if download.packed else path)
    if not opened.is_copy and any(_has_zip(opened.listing, unit) for unit in opened.units):
        copied = CopiedFolder(path, workspace)
        opened = replace(opened, root=workspace, listing=copied, is_copy=True)
    return opened


def _several(
    paths: Sequence[Path], workspace: Path, exercises: Sequence[Exercise], layout: str, stack: ExitStack
) -> Opened:
    make_empty(workspace)
    parts: dict[str, Opened] = {}
    for path in paths:
        name = _name_for(path, parts)
        download = _open(path, workspace / name, exercises, stack, copied=True)
        part = _opened(download, _arranged(path, download, layout), workspace / name)
        about = _exercise_of(name, exercises)
        units = [replace(unit, item=moved(unit.item, name), download=name, exercise=about) for unit in part.units]
        parts[name] = replace(part, units=tuple(units))
    return Opened(
        root=workspace,
        listing=Several({name: part.listing for name, part in parts.items()}),
        is_copy=True,
        layout=", ".join(sorted({part.layout for part in parts.values()})),
        units=_joined([unit for part in parts.values() for unit in part.units], parts, len(exercises)),
        left=tuple((f"{name}/{path}", why) for name, part in parts.items() for path, why in part.left),
        lost=tuple((f"{name}/{path}", why) for name, part in parts.items() for path, why in part.lost),
    )


def _joined(units: list[Unit], parts: dict[str, Opened], exercises: int) -> tuple[Unit, ...]:
    """Entries of all downloads, those of one layout together, so that what is one student's has one identifier."""
    return tuple(
        one
        for name in sorted({part.layout for part in parts.values()})
        for one in students.across_downloads(
            [unit for unit in units if parts[unit.download].layout == name], name, exercises
        )
    )


def _opened(download: Download, arranged: Arrangement, root: Path) -> Opened:
    found = download.listing
    units = arranged.units
    if arranged.metadata is not None:
        found.fetch([arranged.metadata])
        try:
            submissions = gradescope_export.read(root / arranged.metadata.path)
        except OSError:
            submissions = {}
        units = tuple(gradescope_export.with_submitters(units, submissions))
    packed = found if isinstance(found, Archive) else None
    left = (*arranged.left, *(packed.left if packed else ()))
    lost = tuple((one_line(path), reason) for path, reason in packed.lost) if packed else ()
    is_copy = isinstance(found, (Archive, CopiedFolder))
    return Opened(root, found, is_copy, arranged.layout, units, left, lost)


def _open(path: Path, workspace: Path, exercises: Sequence[Exercise], stack: ExitStack, *, copied: bool) -> Download:
    starters = frozenset(name for exercise in exercises for name in (exercise.starter, exercise.notebook))
    if _is_folder(path):
        folder = CopiedFolder(path, workspace) if copied else listing.Folder(path)
        return Download(folder, path.resolve().name, packed=False, starters=starters)
    if not path.is_file():
        raise GradingError(f"There is no folder or zip file {path}.")
    return Download(stack.enter_context(Archive(path, workspace)), path.stem, packed=True, starters=starters)


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except OSError as problem:  # a name that is too long, a folder around it that cannot be read
        raise GradingError(f"{path} cannot be read: {problem.strerror}.") from problem


def _arranged(path: Path, download: Download, layout: str) -> Arrangement:
    try:
        return arrange(download, layout)
    except OSError as problem:
        raise GradingError(f"{path} cannot be read: {problem.strerror}.") from problem


def _downloads(path: Path, exercises: Sequence[Exercise], layout: str) -> list[Path]:
    """The zips in a folder, if they are downloads of one assignment each; else the path itself."""
    if layout not in (AUTO, *recognition.TITLES) or not _is_folder(path):
        return [path]
    try:
        items = recognition.likely(recognition.entries(listing.Folder(path), ""))
    except OSError:
        return [path]  # whoever opens it says so
    if not items or not all(item.is_zip for item in items):
        return [path]
    zips = [path / item.path for item in items]
    kinds = [_is_download(one, exercises) for one in zips]
    if 2 * sum(kinds) <= len(zips):
        return [path]
    if len(zips) == 1 and layout == AUTO:
        raise GradingError(
            f"All of {path} is one zip, {items[0].name}, which looks like a platform's download. If so, name the zip "
            "itself. If it is a student's, add --layout files."
        )
    return zips


def _is_download(path: Path, exercises: Sequence[Exercise]) -> bool:
    if _exercise_of(path.stem, exercises):
        return True
    try:
        with Archive(path, None, NAMES_OF_ONE) as archive:  # of each zip in a folder, whosever it is
            items = recognition.entries(archive, "")
            lone = recognition.likely(items)
            within = recognition.inside(archive, lone[0]) if len(lone) == 1 else []
            return any(
                recognition.looks_like(one, items) or recognition.looks_like(one, within) for one in recognition.TITLES
            )
    except (GradingError, OSError):
        return False


def _exercise_of(name: str, exercises: Sequence[Exercise]) -> str:
    """Which exercise a download is of, by its name; empty when it names none, or two."""
    plain = name.lower().replace("-", "_").replace(" ", "_")
    named = [exercise.id for exercise in exercises if exercise.id in plain]
    return named[0] if len(named) == 1 else ""


def _name_for(path: Path, taken: dict[str, Opened]) -> str:
    """A folder's name for a download: its own, with a number if that is taken."""
    own = (path.stem if not path.is_dir() else path.resolve().name) or "download"
    number = 1
    name = own
    while name in taken:
        number += 1
        name = f"{own} {number}"
    return name


def _has_zip(found: Listing, unit: Unit) -> bool:
    return any(item.is_zip for item in listing.look_through(found, unit.item).files)


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

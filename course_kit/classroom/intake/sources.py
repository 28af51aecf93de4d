"""What an instructor hands over: a folder, a zip, several of them, or a folder with a zip for each assignment."""

from __future__ import annotations

import os
import shutil
from collections import defaultdict
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom.intake import gradescope_export, layouts, listing, recognition
from course_kit.classroom.intake.archive import LARGEST_OF_ONE, Archive, make_empty, open_archive
from course_kit.classroom.intake.gradescope_export import METADATA
from course_kit.classroom.intake.layouts import CLONES, most_fit
from course_kit.classroom.intake.listing import FILE, FOLDER, Folder, Item, move_item
from course_kit.classroom.intake.recognition import AUTO, Download, enter_download, holds_clones, list_entries
from course_kit.grading.errors import GradingError
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from contextlib import ExitStack
    from pathlib import Path

    from course_kit.classroom.intake.layouts import HandIn
    from course_kit.classroom.intake.listing import LeftOut, Listing
    from course_kit.grading.model.exercise import Exercise


@dataclass(frozen=True)
class OpenedSources:
    """What was handed in, and whose each entry is."""

    root: Path  # the folder below which each file lies once it is fetched
    listing: Listing  # everything
    units: tuple[HandIn, ...]  # what each student has control of
    is_copy: bool  # whether the root is a folder of ours, in which more may be unpacked
    layout: str = ""  # the name of the layout; several, with commas, where downloads have different ones
    left: tuple[tuple[str, str], ...] = ()  # path and reason of what lies beside them
    lost: tuple[tuple[str, str], ...] = ()  # of these what may be somebody's only file


def open_all(
    paths: Sequence[Path], workspace: Path, exercises: Sequence[Exercise], layout: str, stack: ExitStack
) -> OpenedSources:
    """Open what was handed over and find the students' entries."""
    paths = [download for path in paths for download in _downloads(path, exercises, layout)]
    if len(paths) > 1:
        return _open_several_downloads(paths, workspace, exercises, layout, stack)
    [path] = paths
    download = _open(path, workspace, exercises, stack, copied=False)
    opened = _read_download(path, download, layout, workspace if download.packed else path)
    found = (file for unit in opened.units for file in listing.look_through(opened.listing, unit.item).files)
    if not opened.is_copy and any(file.is_zip for file in found):
        copied = CopiedFolder(path, workspace)
        opened = replace(opened, root=workspace, listing=copied, is_copy=True)
    return opened


def _open_several_downloads(
    paths: Sequence[Path], workspace: Path, exercises: Sequence[Exercise], layout: str, stack: ExitStack
) -> OpenedSources:
    make_empty(workspace)
    parts: dict[str, OpenedSources] = {}
    for path in paths:
        name = _name_for(path, parts)
        download = _open(path, workspace / name, exercises, stack, copied=True)
        part = _read_download(path, download, layout, workspace / name)
        about = _exercise_of(name, exercises)
        units = [replace(unit, item=move_item(unit.item, name), download=name, exercise=about) for unit in part.units]
        parts[name] = replace(part, units=tuple(units))
    return OpenedSources(
        root=workspace,
        listing=JoinedListings({name: part.listing for name, part in parts.items()}),
        is_copy=True,
        layout=", ".join(sorted({part.layout for part in parts.values()})),
        units=_join_units([unit for part in parts.values() for unit in part.units], parts, len(exercises)),
        left=tuple((f"{name}/{path}", why) for name, part in parts.items() for path, why in part.left),
        lost=tuple((f"{name}/{path}", why) for name, part in parts.items() for path, why in part.lost),
    )


def _join_units(units: list[HandIn], parts: dict[str, OpenedSources], exercises: int) -> tuple[HandIn, ...]:
    """Entries of all downloads, those of one layout together, so that what is one student's has one identifier."""
    return tuple(
        entry
        for name in sorted({part.layout for part in parts.values()})
        for entry in layouts.join_downloads(
            [unit for unit in units if parts[unit.download].layout == name], name, exercises
        )
    )


def _open(path: Path, workspace: Path, exercises: Sequence[Exercise], stack: ExitStack, *, copied: bool) -> Download:
    starters = frozenset(name for exercise in exercises for name in exercise.starters)
    if _is_folder(path):
        folder = CopiedFolder(path, workspace) if copied else listing.Folder(path)
        return Download(folder, path.resolve().name, packed=False, starters=starters)
    if not path.is_file():
        raise GradingError(f"There is no folder or zip file '{path}'. Check its name.")
    return Download(stack.enter_context(open_archive(path, workspace)), path.stem, packed=True, starters=starters)


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except OSError as problem:  # a name that is too long, a folder around it that cannot be read
        raise GradingError(f"{path} cannot be read: {problem.strerror}.") from problem


def _read_download(path: Path, download: Download, layout: str, root: Path) -> OpenedSources:
    """Find the students' entries of one download, whose files lie below `root` once they are fetched."""
    found = download.listing
    left: LeftOut = []
    try:
        layout, called, items = _enter_students(download, layout, left)
        metadata = [item for item in items if layout == "gradescope" and item.name == METADATA and item.kind == FILE]
        others = [item for item in items if item not in metadata]
        read = list(_read_all(found, layout, others, called, left))
    except OSError as problem:
        raise GradingError(f"{path} cannot be read: {problem.strerror}.") from problem
    left += [(item.path, f"its name does not follow the layout '{layout}'") for item, unit in read if unit is None]
    units = layouts.mark_groups([unit for _, unit in read if unit is not None])
    if metadata:
        found.fetch(metadata)
        with suppress(OSError):
            submitters = gradescope_export.read_submitters(root / metadata[0].path)
            units = list(gradescope_export.add_submitters(units, submitters))
    is_copy = isinstance(found, (Archive, CopiedFolder))
    packed = found if isinstance(found, Archive) else None
    left += packed.left if packed else []
    lost = tuple((one_line(path), reason) for path, reason in packed.lost) if packed else ()
    return OpenedSources(root, found, tuple(units), is_copy, layout, tuple(left), lost)


def _enter_students(download: Download, layout: str, left: LeftOut) -> tuple[str, str, list[Item]]:
    """Layout, name and entries of the folder in which the students are."""
    if layout not in (AUTO, *layouts.LAYOUTS):
        raise GradingError(f"There is no layout '{layout}'. Choose one of: {AUTO}, {', '.join(layouts.LAYOUTS)}.")
    folder, called = enter_download(download, layout)
    items = list_entries(download.listing, folder, left)
    return recognition.recognise_layout(download.listing, items, called) if layout == AUTO else layout, called, items


def _downloads(path: Path, exercises: Sequence[Exercise], layout: str) -> list[Path]:
    """The zips in a folder, if they are downloads of one assignment each; else the path itself."""
    if layout not in (AUTO, *recognition.TITLES) or not _is_folder(path):
        return [path]
    try:
        items = recognition.likely_entries(recognition.list_entries(listing.Folder(path), ""))
    except OSError:
        return [path]  # whoever opens it says so
    if not items or not all(item.is_zip for item in items):
        return [path]
    zips = [path / item.path for item in items]
    kinds = [_is_download(item, exercises) for item in zips]
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
        with open_archive(path, None) as archive:
            items = recognition.list_entries(archive, "")
            lone = recognition.likely_entries(items)
            within = recognition.look_inside(archive, lone[0]) if len(lone) == 1 else []
            return any(
                recognition.looks_like(title, items) or recognition.looks_like(title, within)
                for title in recognition.TITLES
            )
    except (GradingError, OSError):
        return False


def _exercise_of(name: str, exercises: Sequence[Exercise]) -> str:
    """Which exercise a download is of, by its name; empty when it names none, or two."""
    plain = name.lower().replace("-", "_").replace(" ", "_")
    named = [exercise.id for exercise in exercises if exercise.id in plain]
    return named[0] if len(named) == 1 else ""


def _name_for(path: Path, taken: dict[str, OpenedSources]) -> str:
    """A folder's name for a download: its own, with a number if that is taken."""
    own = (path.stem if not path.is_dir() else path.resolve().name) or "download"
    number = 1
    name = own
    while name in taken:
        number += 1
        name = f"{own} {number}"
    return name


def _read_all(
    listing: Listing, layout: str, items: list[Item], called: str, left: LeftOut
) -> Iterator[tuple[Item, HandIn | None]]:
    if layout == "github" and most_fit(items, lambda item: holds_clones(listing, item)):
        for item in items:
            if holds_clones(listing, item):
                slug = item.name.removesuffix(CLONES)
                for clone in list_entries(listing, item.path, left):
                    yield clone, layouts.read_unit(layout, clone, slug) or layouts.read_stray(layout, clone)
            else:
                yield item, layouts.read_stray(layout, item)
        return
    slug = recognition.assignment_slug(items, called) if layout == "github" else ""
    for item in items:
        yield item, layouts.read_unit(layout, item, slug) or layouts.read_stray(layout, item)


class CopiedFolder(Folder):
    """A folder; what is fetched of it lies below the workspace afterwards, as with an archive."""

    def __init__(self, root: Path, workspace: Path) -> None:
        super().__init__(root)
        self._source = root
        self._workspace = workspace
        make_empty(workspace)

    def fetch(self, items: Iterable[Item]) -> Mapping[str, str]:
        problems = {item.path: self._copy(item) for item in items}
        return {path: problem for path, problem in problems.items() if problem}

    def _copy(self, item: Item) -> str:
        """Copy one file; the reason if that was not possible."""
        source, target = self._source / item.path, self._workspace / item.path
        if item.kind != FILE:
            return "it is not an ordinary file"
        try:
            state = source.lstat()
            if state.st_size > LARGEST_OF_ONE:
                return f"it is too much: at most {LARGEST_OF_ONE // 1024**2} MB are read"
            apart = os.O_NOFOLLOW | os.O_NONBLOCK
            with open(source, "rb", opener=lambda path, flags: os.open(path, flags | apart)) as file:
                target.parent.mkdir(parents=True, exist_ok=True)
                with target.open("wb") as copy:
                    shutil.copyfileobj(file, copy)
            os.utime(target, ns=(state.st_atime_ns, state.st_mtime_ns))
        except OSError as problem:
            if problem.filename != os.fspath(source):
                raise  # a full disk is nobody's fault
            return f"it cannot be read: {problem.strerror}"
        return ""


class JoinedListings:
    """Several listings as one, each in its own folder."""

    def __init__(self, parts: Mapping[str, Listing]) -> None:
        self._parts = parts

    def children(self, folder: str, most: int | None = None) -> list[Item]:
        name, _, inside = folder.partition("/")
        if not name:
            return [Item(part, FOLDER) for part in sorted(self._parts)]
        return [move_item(item, name) for item in self._parts[name].children(inside, most)]

    def fetch(self, items: Iterable[Item]) -> Mapping[str, str]:
        asked: dict[str, list[Item]] = defaultdict(list)
        for item in items:
            name, _, inside = item.path.partition("/")
            asked[name].append(replace(item, path=inside))
        return {
            f"{name}/{path}": problem
            for name, of_one in asked.items()
            for path, problem in self._parts[name].fetch(of_one).items()
        }

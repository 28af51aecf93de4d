"""Listings made of others: a folder whose files are copied before they are read, and several downloads side by side."""

from __future__ import annotations

import os
import shutil
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from course_kit.classroom.intake.archive import LARGEST_OF_ONE, make_empty
from course_kit.classroom.intake.listing import FILE, FOLDER, Folder, Item

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from course_kit.classroom.intake.listing import Listing


class CopiedFolder(Folder):
    """A folder; what is fetched of it lies below the workspace afterwards, as with an archive."""

    def __init__(self, root: Path, workspace: Path) -> None:
        super().__init__(root)
        self._source = root
        self._workspace = workspace
        make_empty(workspace)

    def fetch(self, items: Iterable[Item]) -> Mapping[str, str]:
        """See `Listing`."""
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
            with open(source, "rb", opener=_not_through_a_link) as file:
                target.parent.mkdir(parents=True, exist_ok=True)
                with target.open("wb") as copy:
                    shutil.copyfileobj(file, copy)
            os.utime(target, ns=(state.st_atime_ns, state.st_mtime_ns))
        except OSError as problem:
            if problem.filename != os.fspath(source):
                raise  # a full disk is nobody's fault
            return f"it cannot be read: {problem.strerror}"
        return ""


def _not_through_a_link(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_NOFOLLOW | os.O_NONBLOCK)


class Several:
    """Several listings as one, each in a folder of its own."""

    def __init__(self, parts: Mapping[str, Listing]) -> None:
        self._parts = parts

    def children(self, folder: str, most: int | None = None) -> list[Item]:
        """See `Listing`."""
        name, _, inside = folder.partition("/")
        if not name:
            return [Item(one, FOLDER) for one in sorted(self._parts)]
        return [moved(item, name) for item in self._parts[name].children(inside, most)]

    def fetch(self, items: Iterable[Item]) -> Mapping[str, str]:
        """See `Listing`."""
        asked: dict[str, list[Item]] = defaultdict(list)
        for item in items:
            name, _, inside = item.path.partition("/")
            asked[name].append(replace(item, path=inside))
        return {
            f"{name}/{path}": problem
            for name, of_one in asked.items()
            for path, problem in self._parts[name].fetch(of_one).items()
        }


def moved(item: Item, folder: str) -> Item:
    """An item as it is seen from the folder around its root."""
    return replace(item, path=f"{folder}/{item.path}") if folder else item

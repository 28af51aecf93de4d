"""What was handed in, by names alone: nothing is opened, no link is followed, and one student's heap stays theirs."""

from __future__ import annotations

import itertools
import os
from collections import deque
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

from course_kit.reader.text import kind_of_file as kind_of_program

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

ZIP = ".zip"
FOLDER, FILE, LINK, OTHER = "folder", "file", "link", "other"
MOST = 20_000  # files and folders of one student that are looked at
DEEPEST = 30  # folders within folders

# Written by platforms, editors and tools, not by students; each is one line in the list of what was left.
_TOOLS_FOLDERS = frozenset(
    {".git", ".github", "__MACOSX", "__pycache__", ".ipynb_checkpoints", ".venv", "node_modules", ".idea", ".vscode"}
    | {".mypy_cache", ".pytest_cache", ".ruff_cache"}
)
_TOOLS_FILES = frozenset({".DS_Store", "Thumbs.db", "desktop.ini", "Icon\r"})
_TOOLS_BEGINNINGS = ("._", "~$", ".~lock.")  # a Mac's second half of a file; what office programs have open

LeftOut = list[tuple[str, str]]


@dataclass(frozen=True)
class Item:
    """A file or folder."""

    path: str  # from the root, with forward slashes
    kind: str  # FOLDER, FILE, LINK or OTHER, which is a pipe, a device and the like
    problem: str = ""  # why it cannot be had; empty when nothing is known against it

    @property
    def name(self) -> str:
        """The last part of the path."""
        return self.path.rpartition("/")[2]

    @property
    def is_program(self) -> bool:
        """Whether it is named as a submission is."""
        return self.kind != FOLDER and bool(kind_of_program(self.name))

    @property
    def is_zip(self) -> bool:
        """Whether it is named as a zip archive is."""
        return self.kind == FILE and self.name.lower().endswith(ZIP)


def move_item(item: Item, folder: str) -> Item:
    """An item as it is seen from the folder around its root."""
    return replace(item, path=f"{folder}/{item.path}") if folder else item


class Listing(Protocol):
    """A folder or an archive."""

    def children(self, folder: str, most: int | None = None) -> list[Item]:
        """What lies in a folder, by name; `""` is the root. With `most` no more than so many, whichever they are."""

    def fetch(self, items: Iterable[Item]) -> Mapping[str, str]:
        """Have one student's files ready below the root; returns path and problem of each that cannot be."""


class Folder:
    """A folder of this machine."""

    def __init__(self, root: Path) -> None:
        self._root = root

    def children(self, folder: str, most: int | None = None) -> list[Item]:
        start = f"{folder}/" if folder else ""
        with os.scandir(self._root / folder) as found:
            items = [Item(f"{start}{entry.name}", _kind(entry)) for entry in itertools.islice(found, most)]
        return sorted(items, key=lambda item: item.path)

    def fetch(self, items: Iterable[Item]) -> Mapping[str, str]:
        """See `Listing`; everything is here already."""
        del items
        return {}


def _kind(entry: os.DirEntry[str]) -> str:
    if entry.is_symlink():
        return LINK
    if entry.is_dir(follow_symlinks=False):
        return FOLDER
    return FILE if entry.is_file(follow_symlinks=False) else OTHER


def why_a_tools(item: Item) -> str:
    """Why an item is nobody's work; empty when it may be."""
    if item.kind == FOLDER:
        return "a folder of a tool" if item.name in _TOOLS_FOLDERS else ""
    if item.name in _TOOLS_FILES or item.name.startswith(_TOOLS_BEGINNINGS):
        return "a file of a tool"
    return ""


@dataclass(frozen=True)
class StudentFiles:
    """What is below one student's entry."""

    files: tuple[Item, ...]  # the files, those nearest to the top first
    tools: tuple[tuple[str, str], ...] = ()  # path and reason of what is nobody's work
    # path and reason of what might have been a submission, and was not looked at
    unseen: tuple[tuple[str, str], ...] = ()
    problem: str = ""  # why nothing of it can be had, as of a zip that cannot be opened


def look_through(listing: Listing, top: Item) -> StudentFiles:
    """Find the files of one student, however many or deep they are, without following a link."""
    if top.kind != FOLDER:  # a link may lead to anybody's work
        problem = {LINK: "it is a link, and links are not followed", OTHER: "it is not an ordinary file"}
        return StudentFiles((replace(top, problem=top.problem or problem.get(top.kind, "")),))
    files: list[Item] = []
    tools: LeftOut = []
    unseen: LeftOut = []
    for seen, (item, depth) in enumerate(_walk(listing, top, unseen), start=1):
        if seen > MOST:
            unseen.append((top.path, f"it holds more than {MOST} files and folders; the rest was not read"))
            break
        if reason := why_a_tools(item):
            tools.append((item.path, reason))
        elif item.kind == FOLDER and depth > DEEPEST:
            unseen.append((item.path, f"it lies in more than {DEEPEST} folders within folders"))
        elif item.kind in (FILE, OTHER) or item.is_program:
            files.append(item)
        elif item.kind == LINK:
            unseen.append((item.path, "it is a link, and links are not followed"))
    return StudentFiles(tuple(files), tuple(tools), tuple(unseen))


def _walk(listing: Listing, top: Item, unseen: LeftOut) -> Iterator[tuple[Item, int]]:
    """Everything below a folder but what is in folders of tools, level by level, with its depth."""
    folders = deque([(top.path, 1)])
    while folders:
        folder, depth = folders.popleft()
        try:
            children = listing.children(folder, MOST + 1)
        except OSError as problem:
            unseen.append((folder, f"it cannot be listed: {problem.strerror}"))
            continue
        for item in children:
            yield item, depth
            if item.kind == FOLDER and depth <= DEEPEST and not why_a_tools(item):
                folders.append((item.path, depth + 1))

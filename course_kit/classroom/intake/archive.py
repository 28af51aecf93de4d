"""An archive of submissions: bytes from strangers, so nothing of it may land elsewhere, fill the disk or stop the rest.

What the archive says of itself is read once. Then each student's programs are unpacked for themselves, within limits
for each student, so that one who hands in a bomb has a problem, and nobody else.
"""

from __future__ import annotations

import errno
import itertools
import os
import shutil
import stat
import struct
import time
import zipfile
import zlib
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from course_kit.classroom.intake.listing import FILE, FOLDER, LINK, OTHER, Item, StudentFiles, look_through, move_item
from course_kit.grading.errors import GradingError
from course_kit.process import Closable
from course_kit.reader.files import YAML

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

LARGEST_OF_ONE = 64 * 1024**2  # bytes from one student: of a zip, and of what is unpacked
MOST_OF_ONE = 1000  # files unpacked of one student
DEEPEST = 40  # parts of a path
CONTENTS = ".contents"  # added to a student's zip's name, of the folder with what was in it
MOST_ZIPS = 3  # of one student
_LONGEST_PART = 255  # bytes of a part of a path: Linux's NAME_MAX
_BLOCK = 1024 * 1024
_ALSO_A_FOLDER = "the archive also holds a folder with this name"
_SEALED = 0x1  # the flag of an encrypted member
# Others, such as bzip2 and LZMA, are unpacked by Python in steps whose size the archive determines.
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_ITS_NAMES_FAULT = (errno.ENAMETOOLONG, errno.EINVAL, errno.EILSEQ, errno.ENOTDIR, errno.EISDIR, errno.ENOENT)
_BROKEN = (zipfile.BadZipFile, EOFError, ValueError, OverflowError, NotImplementedError, struct.error, zlib.error)


class Archive(Closable):
    """A zip as a `Listing`: what is fetched lies below the workspace afterwards."""

    def __init__(self, opened: zipfile.ZipFile, workspace: Path | None) -> None:
        self._zip = opened
        self._workspace = workspace
        self._had: dict[str, str] = {}  # what was unpacked already, and the problem if it could not be
        self.left: list[tuple[str, str]] = []  # path and reason of members that are in no folder's list
        self.lost: list[tuple[str, str]] = []  # of these, what may be somebody's only file
        self._members: dict[str, zipfile.ZipInfo] = {}
        self._folders: dict[str, dict[str, Item]] = {"": {}}

    def close(self) -> None:
        """Close the file."""
        self._zip.close()

    def children(self, folder: str, most: int | None = None) -> list[Item]:
        items = itertools.islice(self._folders.get(folder, {}).values(), most)
        return sorted(items, key=lambda item: item.path)

    def fetch(self, items: Iterable[Item]) -> Mapping[str, str]:
        """See `Listing`; small files come first, so that a large one takes no place from them."""
        asked = [item for item in items if not item.problem]
        problems = {item.path: self._had[item.path] for item in asked if self._had.get(item.path)}
        wanted = sorted(
            (item for item in asked if item.path not in self._had), key=lambda item: self._members[item.path].file_size
        )
        size = 0
        for place, item in enumerate(wanted):
            member = self._members[item.path]
            size += member.file_size
            if size > LARGEST_OF_ONE or place >= MOST_OF_ONE:
                problems[item.path] = (
                    f"it is too much: at most {MOST_OF_ONE} files of {LARGEST_OF_ONE // 1024**2} MB "
                    "together are unpacked for one student"
                )
                continue
            self._had[item.path] = self._unpack(member, item.path)
            if self._had[item.path]:
                problems[item.path] = self._had[item.path]
        return problems

    def list_members(self) -> None:
        """Note what is in it, by folder."""
        members = self._zip.infolist()
        separator = _separator(members)
        for member in members:
            name = member.filename.replace(separator, "/")
            parts = [part for part in name.split("/") if part not in ("", ".")]
            path = "/".join(parts)
            if name.startswith("/") or ".." in parts:
                self._lose(member.filename, "its name leads outside the archive")
            elif len(parts) > DEEPEST:
                self._add_file(Item(path, FILE, f"it lies in more than {DEEPEST} folders within folders"), parts[0])
            elif name.endswith("/"):
                self._add_folder(path)
            elif parts:
                if path in self._members:
                    self.left.append((path, "the archive holds a second file with this name, and that one was used"))
                self._members[path] = member
                kind = _kind(member)
                self._add_file(Item(path, kind, _problem(member, path, kind)), path.rpartition("/")[0])

    def _add_file(self, item: Item, folder: str) -> None:
        self._add_folder(folder)
        if item.path in self._folders:
            self._lose(item.path, _ALSO_A_FOLDER)
        else:
            self._folders[folder][item.path] = item

    def _add_folder(self, folder: str) -> None:
        if folder in self._folders:
            return
        parent = folder.rpartition("/")[0]
        self._add_folder(parent)
        if folder in self._folders[parent]:
            self._lose(folder, _ALSO_A_FOLDER)
        self._folders[parent][folder] = Item(folder, FOLDER)
        self._folders[folder] = {}

    def _lose(self, path: str, reason: str) -> None:
        self.left.append((path, reason))
        self.lost.append((path, reason))

    def _unpack(self, member: zipfile.ZipInfo, path: str) -> str:
        """Write one member; the reason if that was not possible, and then nothing of it is left."""
        if self._workspace is None:
            return "only the names in it were read"
        target = self._workspace / path
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            with self._zip.open(member) as source, target.open("xb") as file:
                left = member.file_size  # what its head says; one that unpacks to more is no submission
                while block := source.read(min(_BLOCK, left + 1)):
                    left -= len(block)
                    if left < 0:
                        raise zipfile.BadZipFile("it unpacks to more than its declared size")
                    file.write(block)
        except FileExistsError:
            return "it cannot be unpacked: a file with this name already exists"
        except (*_BROKEN, OSError, RuntimeError) as problem:
            if isinstance(problem, OSError) and problem.errno not in _ITS_NAMES_FAULT:
                raise  # a full disk is nobody's fault
            with suppress(OSError):
                target.unlink()
            return f"it cannot be unpacked: {getattr(problem, 'strerror', None) or problem}"
        _set_time(target, member)
        return ""


def _separator(members: list[zipfile.ZipInfo]) -> str:
    """What stands between folders: a backslash where no name has a slash, as some programs for Windows write it."""
    return "/" if any("/" in member.filename for member in members) else "\\"


def _kind(member: zipfile.ZipInfo) -> str:
    kind = stat.S_IFMT(member.external_attr >> 16)
    if kind == stat.S_IFLNK:
        return LINK
    return FILE if kind in (0, stat.S_IFREG) else OTHER


def _problem(member: zipfile.ZipInfo, path: str, kind: str) -> str:
    """Why a member is not unpacked, as far as its head tells."""
    if kind != FILE:
        return "it is a link" if kind == LINK else "it is not an ordinary file"
    if member.flag_bits & _SEALED:
        return "it is encrypted"
    if member.compress_type not in _METHODS:
        return "it is compressed with a method that is not supported here"
    if any(len(part.encode(errors="surrogatepass")) > _LONGEST_PART for part in path.split("/")):
        return "its name is too long"
    return ""


def _set_time(target: Path, member: zipfile.ZipInfo) -> None:
    """Of two files the newer one counts; an archive tells the local time, in steps of two seconds."""
    with suppress(ValueError, OverflowError, OSError):
        moment = time.mktime((*member.date_time, 0, 0, -1))
        os.utime(target, (moment, moment))


def make_empty(workspace: Path) -> None:
    """Make the folder, or empty the one of an earlier run; a file beside it marks it, as any name may be in it."""
    mark = workspace.with_name(f".{workspace.name}_is_unpacked")
    if not mark.exists() and workspace.exists() and any(workspace.iterdir()):
        raise GradingError(
            f"The archive has to be unpacked into {workspace}, but that already exists. Move it away first."
        )
    workspace.mkdir(parents=True, exist_ok=True)
    mark.touch()
    shutil.rmtree(workspace)
    workspace.mkdir()


def open_archive(path: Path, workspace: Path | None) -> Archive:
    """Open a zip and list what is in it; the workspace is empty afterwards."""
    try:
        archive = Archive(zipfile.ZipFile(path), workspace)
    except OSError as problem:
        raise GradingError(f"{path} cannot be read: {problem.strerror or problem}.") from problem
    except _BROKEN as problem:
        raise GradingError(f"{path.name} cannot be read as a zip archive: {problem}.") from problem
    try:
        archive.list_members()
        if workspace is not None:
            make_empty(workspace)
    except BaseException:
        archive.close()
        raise
    return archive


def unpack_students_zip(root: Path, item: Item) -> StudentFiles:
    """Open a zip that a student has handed in, beside itself; what goes wrong is theirs alone."""
    folder = f"{item.path}{CONTENTS}"
    try:
        if (root / item.path).stat().st_size > LARGEST_OF_ONE:  # a list of names alone may fill the memory
            return StudentFiles((), problem=f"it is too much: at most {LARGEST_OF_ONE >> 20} MB are opened")
        with open_archive(root / item.path, root / folder) as archive:
            found = look_through(archive, Item("", FOLDER))
            wanted = [
                file for file in found.files if file.is_program or file.name.endswith(YAML) or len(found.files) == 1
            ]
            problems = archive.fetch(wanted)
            lost = [*found.unseen, *archive.lost]
    except GradingError as problem:
        return StudentFiles((), problem=str(problem))
    except OSError as problem:
        if problem.errno not in _ITS_NAMES_FAULT:
            raise
        return StudentFiles((), problem=f"it cannot be unpacked: {problem.strerror}")
    items = (replace(item, problem=item.problem or problems.get(item.path, "")) for item in found.files)
    return StudentFiles(
        tuple(move_item(item, folder) for item in items),
        tuple((f"{folder}/{path}", reason) for path, reason in found.tools),
        tuple((f"{folder}/{path}" if path else folder, reason) for path, reason in lost),
    )

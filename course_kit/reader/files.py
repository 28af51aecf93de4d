"""A submission of several files, out of the bytes of a zip archive, a notebook, or one of the files alone."""

from __future__ import annotations

import re
from collections import Counter
from posixpath import basename, dirname

from course_kit.reader import text

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import BinaryIO
    from zipfile import ZipFile

    # Of one file: why it cannot be read, or its text and the cells it was joined from.
    Read = str | tuple[str, list[tuple[str, int]]]

ARCHIVE, YAML = ".zip", ".yaml"
MOST_FILES = 40  # of a submission; more *.py and *.yaml beside those that the exercise names are its own modules
_NAME = re.compile(r"\w[\w.-]{0,99}\.(?:py|yaml)")
_CELL = re.compile(r"^[ \t]*%%submission[^\S\n]+(\S+)[^\S\n]+(\S+)", re.MULTILINE)
_LEFT_OUT = re.compile(r"/$|(?:^|/)(?:\.|(?:__pycache__|__MACOSX|build|install|log)/)")  # folders, and files of tools


def is_name(name: str) -> bool:
    """Whether a submission can have a file of this name."""
    return _NAME.fullmatch(name) is not None


def read_files(name: str, file: BinaryIO, exercise: str, wanted: Sequence[str]) -> dict[str, Read]:
    """What is in each file of a submission."""
    import zipfile
    import zlib

    if text.kind_of_file(name) == text.NOTEBOOK:
        return _of_notebook(name, file.read(), exercise)
    if not name.lower().endswith(ARCHIVE):
        return {name: _read_file(name, file.read())} if is_name(name) else {}
    try:
        return _of_archive(name, zipfile.ZipFile(file), exercise, wanted)
    except text.UnreadableTextError:
        raise
    except (zipfile.BadZipFile, zlib.error, RuntimeError, ValueError, OSError, EOFError) as problem:
        why = f"{name} cannot be unpacked ({problem}). Pack it again as a plain zip."
        raise text.UnreadableTextError(why) from None


def _read_file(name: str, data: bytes) -> Read:
    try:
        source = text.read_text(name, text.decode_text(name, data))
    except text.UnreadableTextError as problem:
        return str(problem)
    return f"{name} contains null bytes." if "\0" in source else (source, [])


def _of_notebook(name: str, data: bytes, exercise: str) -> dict[str, Read]:
    cells = text.code_cells(name, text.decode_text(name, data))
    named = [match[2] for _, cell in cells if (match := _CELL.search(cell)) and match[1] == exercise]
    if not named:
        text.join_cells(name, cells, exercise, "FILE")  # says what is missing
    found: dict[str, Read] = {}
    for file in list(dict.fromkeys(filter(is_name, named)))[:MOST_FILES]:
        try:
            found[file] = text.join_cells(name, cells, exercise, file)
        except text.UnreadableTextError as problem:  # noqa: PERF203 - the others are read all the same
            found[file] = str(problem)
    return found


def _of_archive(name: str, archive: ZipFile, exercise: str, wanted: Sequence[str]) -> dict[str, Read]:
    """The files of that folder of an archive in which most of the wanted ones lie; else of its only notebook."""
    sizes = {info.filename: info.file_size for info in archive.infolist() if not _LEFT_OUT.search(info.filename)}
    counts = Counter(dirname(path) for path in sizes if basename(path) in wanted)
    notebooks = [path for path in sizes if text.kind_of_file(path) == text.NOTEBOOK]
    if not counts and len(notebooks) == 1:
        return _of_notebook(notebooks[0], archive.read(notebooks[0]), exercise)
    folder = min(counts, key=lambda place: (-counts[place], place.count("/"), place), default=None)  # the topmost
    members = [path for path in sizes if dirname(path) == folder and is_name(basename(path))]
    members = sorted(members, key=lambda path: (basename(path) not in wanted, path))[:MOST_FILES]
    if sum(sizes[path] for path in members) > text.LARGEST:
        why = f"{name} holds more than {text.LARGEST // 1024} kB of code. Hand in only your own files."
        raise text.UnreadableTextError(why)
    return {basename(path): _read_file(basename(path), archive.read(path)) for path in members}


def join_sources(read: Mapping[str, Read]) -> str:
    """All that could be read, one file below the other."""
    return "\n".join(f"# {name}\n{cell[0]}" for name, cell in sorted(read.items()) if not isinstance(cell, str))

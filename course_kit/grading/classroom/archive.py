"""Unpacks an archive of submissions: bytes from strangers, so nothing of it may land elsewhere or fill the disk."""

from __future__ import annotations

import stat
import zipfile
from pathlib import Path, PurePosixPath

from course_kit.grading.errors import GradingError

LARGEST = 2 * 1024**3  # bytes unpacked; 30,000 submissions of 64 kB
MOST = 300_000  # files
_BLOCK = 1024 * 1024


def unpack(archive: Path, folder: Path) -> list[tuple[str, str]]:
    """Unpack a zip.

    Args:
        archive: the zip.
        folder: where to; what is there already is written over.

    Returns:
        path and reason of each member that was left where it is.

    Raises:
        GradingError: it is no zip that can be read, or too large.
    """
    refused = []
    try:
        with zipfile.ZipFile(archive) as packed:
            members = [member for member in packed.infolist() if not member.is_dir()]
            size = sum(member.file_size for member in members)
            if size > LARGEST or len(members) > MOST:
                raise GradingError(
                    f"{archive.name} would unpack to {len(members)} files of {size // 1024**2} MB together, and the "
                    f"limits are {MOST} files and {LARGEST // 1024**2} MB. Split it."
                )
            for member in members:
                reason = _reason_to_refuse(member) or _extract(packed, member, folder)
                if reason:
                    refused.append((member.filename, reason))
    except (zipfile.BadZipFile, EOFError) as problem:
        raise GradingError(f"{archive.name} is no zip archive that can be read: {problem}.") from problem
    return refused


def _reason_to_refuse(member: zipfile.ZipInfo) -> str:
    path = PurePosixPath(member.filename)
    if path.is_absolute() or ".." in path.parts or "\0" in member.filename:
        return "its name leads out of the archive"
    if stat.S_ISLNK(member.external_attr >> 16):
        return "it is a link"
    return ""


def _extract(packed: zipfile.ZipFile, member: zipfile.ZipInfo, folder: Path) -> str:
    """Write one member; the reason if that was not possible."""
    target = folder / Path(*PurePosixPath(member.filename).parts)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        left = member.file_size  # what its head says; one that unpacks to more is cut there and refused
        with packed.open(member) as source, target.open("wb") as file:
            while block := source.read(min(_BLOCK, left + 1)):
                left -= len(block)
                if left < 0:
                    return "it unpacks to more than it says"
                file.write(block)
    except (OSError, RuntimeError, NotImplementedError, zipfile.BadZipFile, EOFError) as problem:
        return f"it cannot be unpacked: {problem}"
    return ""

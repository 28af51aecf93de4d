"""When a submission was handed in, as far as anything but a student's own file times tells it.

The platform tells it, as Gradescope's list does, or nbgrader's `timestamp.txt` where nbgrader writes it, and nowhere
else, for there it is the student's own. The intake keeps what they say with the submission.
"""

from __future__ import annotations

import os
import re
from contextlib import suppress
from datetime import datetime, timezone
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

if TYPE_CHECKING:
    from datetime import tzinfo
    from pathlib import Path

    from course_kit.classroom.records import Entry

STAMP = "timestamp.txt"
SUBMITTED_AT, ASSIGNMENT = "submitted_at", "nbgrader_assignment"  # see `Entry.platform`
_LONGEST_STAMP = 200  # bytes
_STAMP = re.compile(r"(?P<time>\d{4}-\d\d-\d\d[ T]\d\d:\d\d(:\d\d(\.\d{1,9})?)?)\s*(?P<zone>[\w/+:-]*)", re.ASCII)
_OFFSET = re.compile(r"[+-]\d\d:?\d\d\Z")


def submitted(entry: Entry, zone: tzinfo | None = None) -> datetime | None:
    """When an entry was handed in; None where nothing tells. `zone` gives abbreviations such as CET their meaning."""
    return parse_stamp(entry.platform.get(SUBMITTED_AT, ""), zone)


def comes_twice(moment: datetime) -> bool:
    """Whether clocks showed this time twice, and nothing tells which of the two is meant."""
    return isinstance(moment.tzinfo, ZoneInfo) and moment.utcoffset() > moment.replace(fold=1).utcoffset()  # type: ignore[operator]


def parse_stamp(text: str, zone: tzinfo | None = None) -> datetime | None:
    """What nbgrader has noted: `2026-11-20 22:59:00.000000 UTC`; None where its zone is not known.

    Without a zone it is UTC, as nbgrader takes it. A time that comes twice is the earlier, if its zone does not tell.
    """
    match = _STAMP.fullmatch(text.strip())
    if match is None:
        return None
    try:
        moment = datetime.fromisoformat(match["time"].partition(".")[0])  # whole seconds, as all Pythons read them
    except ValueError:
        return None
    return _in_zone(moment, match["zone"], zone)


def _in_zone(moment: datetime, name: str, zone: tzinfo | None) -> datetime | None:
    if name in ("", "UTC", "GMT", "Z"):
        return moment.replace(tzinfo=timezone.utc)
    if _OFFSET.match(name):
        return datetime.fromisoformat(f"{moment.isoformat()}{name[:3]}:{name[-2:]}")
    zones = [zone] if zone is not None else []
    with suppress(ZoneInfoNotFoundError, ValueError, OSError):
        zones.append(ZoneInfo(name))
    for one in zones:  # CET and CEST say which of two hours it is
        for local in (moment.replace(tzinfo=one, fold=0), moment.replace(tzinfo=one, fold=1)):
            if local.tzname() == name:
                return local.astimezone(timezone(local.utcoffset(), name))  # type: ignore[arg-type]
    return moment.replace(tzinfo=zones[-1]) if len(zones) > (zone is not None) else None


def read_stamp(path: Path) -> str:
    """The text of nbgrader's stamp; empty where there is none that is a small ordinary file."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError):
        return ""
    with os.fdopen(descriptor, "rb") as file, suppress(OSError):  # a folder, say
        return file.read(_LONGEST_STAMP).decode(errors="replace").strip()
    return ""

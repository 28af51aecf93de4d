"""Due dates: `class.toml` and `extensions.csv` in the folder of the results, and what they make of a late submission.

Nothing is guessed about time zones: a date has its offset from UTC, or the file names the zone it is meant in.
"""

from __future__ import annotations

import math
import os
import re
import sys
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import msgspec

from course_kit.classroom.rules.adjustments import Adjustment
from course_kit.classroom.rules.people import Mistakes, StudentTable, describe_unknown, read_rows
from course_kit.grading.errors import GradingError
from course_kit.grading.model.exercise import Exercise, list_exercise_ids
from course_kit.grading.model.plain_data import convert_record

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from datetime import tzinfo

FILE, EXTENSIONS = "class.toml", "extensions.csv"
_DAY_S, _MINUTE_S, _ALL = 86_400, 60, 100
_Number: TypeAlias = Annotated[float, msgspec.Meta(ge=0, le=sys.float_info.max)]
STAMP = "timestamp.txt"
SUBMITTED_AT, ASSIGNMENT = "submitted_at", "nbgrader_assignment"  # see `Entry.platform`
_LONGEST_STAMP = 200  # bytes
_STAMP = re.compile(r"(?P<time>\d{4}-\d\d-\d\d[ T]\d\d:\d\d(:\d\d(\.\d{1,9})?)?)\s*(?P<zone>[\w/+:-]*)", re.ASCII)
_OFFSET = re.compile(r"[+-]\d\d:?\d\d\Z")


@dataclass(frozen=True)
class Deadlines:
    """Due dates and late penalties."""

    due: Mapping[str, datetime] = field(default_factory=dict)  # by exercise; those that are not in it have no due date
    # the zone of dates without an offset, and of what students read; None when none is named
    zone: tzinfo | None = None
    grace_s: float = 0.0  # so many seconds late is not late
    percent_per_day: float = 0.0  # of full marks, for each day begun after the due date
    at_most_percent: float = float(_ALL)  # of full marks; no penalty is higher
    # other due dates, by student and exercise
    extensions: StudentTable[datetime] = field(default_factory=lambda: StudentTable(Mistakes(Path(EXTENSIONS))))

    def judge(self, student: str, exercise: Exercise, submitted: datetime | None, *, marked: bool) -> Adjustment:
        """Whether a submission is late, and what that costs."""
        own = self.extensions.find(student, exercise.id)
        due = own or self.due.get(exercise.id)
        known = Adjustment(pass_mark=exercise.pass_mark, submitted=submitted, due=due, extended=own is not None)
        if due is None:
            return replace(known, late=marked)
        if submitted is None:
            return self._without_time(known, exercise, marked=marked)
        if comes_twice(submitted):
            known = replace(known, warning="clocks showed this submission time twice; the earlier one counts")
        submitted = submitted.astimezone(due.tzinfo)
        known = replace(known, submitted=submitted)
        late_s = submitted.timestamp() - due.timestamp()  # of two in one zone Python would leave out clock changes
        if late_s <= self.grace_s:
            return known
        return replace(known, late=True, late_s=late_s, penalty=self._penalty(exercise, math.ceil(late_s / _DAY_S)))

    def _without_time(self, known: Adjustment, exercise: Exercise, *, marked: bool) -> Adjustment:
        if not marked:
            return replace(known, warning="its submission time is unknown, so it counts as on time")
        if known.extended:
            return replace(
                known, warning="marked as late without a time, and its date was extended; it counts as on time"
            )
        return replace(
            known,
            late=True,
            penalty=self._penalty(exercise, 1),
            warning="marked as late without a time; it counts as one day",
        )

    def _penalty(self, exercise: Exercise, days: int) -> float:
        return round(exercise.points * min(days * self.percent_per_day, self.at_most_percent) / _ALL, 6)


def read_deadlines(folder: Path, exercises: Sequence[Exercise]) -> Deadlines:
    """Read the two files, as far as they are there."""
    settings = folder / FILE
    found = _rules(settings, exercises) if settings.exists() else Deadlines()
    path = folder / EXTENSIONS
    if not path.exists():
        return found
    return _with_extensions(found, path, exercises)


def _rules(path: Path, exercises: Sequence[Exercise]) -> Deadlines:
    try:
        table = msgspec.toml.decode(path.read_text(encoding="utf-8"))
        return _parse(table, _of_course(exercises))
    except OSError as problem:
        raise GradingError(f"{path} could not be read: {problem.strerror}.") from problem
    except ValueError as problem:  # what the parser says names the line
        raise GradingError(f"{path} cannot be used: {problem}.") from problem


class _Settings(msgspec.Struct, forbid_unknown_fields=True):
    """What stands in class.toml; for what it is about see `Deadlines`."""

    timezone: str = ""
    due: dict[str, Any] = {}  # moments, see `parse_moment`
    grace_minutes: _Number = 0.0
    penalty_percent_per_day: _Number = 0.0
    penalty_at_most_percent: _Number = float(_ALL)


def _parse(table: dict[str, Any], exercises: Sequence[str]) -> Deadlines:
    settings = convert_record(table, _Settings)
    zone = _zone(settings.timezone) if settings.timezone else None
    found = {}
    for exercise, moment in settings.due.items():
        if exercise in _Settings.__struct_fields__:
            raise ValueError(f"'{exercise}' stands below [due]; it has to stand above it")
        if exercise not in exercises:
            raise ValueError(f"below [due]: {describe_unknown('exercise', exercise, exercises)}".rstrip("."))
        found[exercise] = parse_moment(moment, zone, f"'{exercise}' below [due]")
    return Deadlines(
        due=found,
        zone=zone,
        grace_s=settings.grace_minutes * _MINUTE_S,
        percent_per_day=settings.penalty_percent_per_day,
        at_most_percent=settings.penalty_at_most_percent,
    )


def _of_course(exercises: Sequence[Exercise]) -> list[str]:
    """All exercises of the course: one file may serve runs that each grade a part of it."""
    folders = {exercise.folder.parent for exercise in exercises}
    return sorted({exercise.id for exercise in exercises}.union(*map(list_exercise_ids, folders)))


def _zone(name: str) -> tzinfo:
    if name == "UTC":
        return timezone.utc
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        raise ValueError(
            f"this machine does not know the time zone '{name}'. Names look like 'Europe/Berlin'. If this machine "
            'has no list of time zones, delete the line and write offsets, such as "2026-11-20T23:59:00+01:00"'
        ) from None


def parse_moment(value: Any, zone: tzinfo | None, what: str) -> datetime:
    """A date and time with its zone."""
    try:
        text = f"{str(value)[:-1]}+00:00" if str(value).endswith("Z") else str(value)  # as all Pythons read it
        moment = value if isinstance(value, datetime) else datetime.fromisoformat(text)
    except ValueError:
        raise ValueError(f"{what}: '{value}' is not a date with a time, such as 2026-11-20 23:59") from None
    if not isinstance(value, datetime) and ":" not in str(value):
        raise ValueError(f"{what}: '{value}' has no time of day; write 2026-11-20 23:59")
    if moment.tzinfo is not None:
        return moment
    if zone is None:
        raise ValueError(
            f'{what}: it is unclear which time zone {value} is meant in. Add timezone = "Europe/Berlin", or the like, '
            f"at the top of {FILE}, or an offset such as +01:00 to the time"
        )
    return moment.replace(tzinfo=zone)


def _with_extensions(rules: Deadlines, path: Path, exercises: Sequence[Exercise]) -> Deadlines:
    """Lines without an exercise are for all of them."""
    ids = _of_course(exercises)
    found: StudentTable[datetime] = StudentTable(Mistakes(path))
    for row in read_rows(path, ("student", "due"), ("exercise",)):
        exercise = row.cells["exercise"]
        try:
            moment = parse_moment(row.cells["due"], rules.zone, "due")
        except ValueError as problem:
            found.mistakes.add(row.line, str(problem))
            continue
        if exercise and exercise not in ids:
            found.mistakes.add(row.line, describe_unknown("exercise", exercise, ids))
        for name in [exercise] if exercise else ids:
            found.put(row, name, moment)
    return replace(rules, extensions=found)


def comes_twice(moment: datetime) -> bool:
    """Whether clocks showed this time twice, and nothing tells which of the two is meant."""
    return isinstance(moment.tzinfo, ZoneInfo) and moment.utcoffset() > moment.replace(fold=1).utcoffset()  # type: ignore[operator]


def parse_stamp(text: str, zone: tzinfo | None = None) -> datetime | None:
    """What nbgrader has noted: `2026-11-20 22:59:00.000000 UTC`; None where its zone is not known.

    Without a zone it is UTC, as nbgrader takes it. A time that comes twice is the earlier, if its zone does not tell.
    `zone` gives abbreviations such as CET their meaning.
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
    for other in zones:  # CET and CEST say which of two hours it is
        for local in (moment.replace(tzinfo=other, fold=0), moment.replace(tzinfo=other, fold=1)):
            if local.tzname() == name:
                return local.astimezone(timezone(local.utcoffset(), name))  # type: ignore[arg-type]
    return moment.replace(tzinfo=zones[-1]) if len(zones) > (zone is not None) else None


def read_stamp(path: Path) -> str:
    """The text of nbgrader's stamp; empty unless it is a small ordinary file."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError):
        return ""
    with os.fdopen(descriptor, "rb") as file, suppress(OSError):  # a folder, say
        return file.read(_LONGEST_STAMP).decode(errors="replace").strip()
    return ""

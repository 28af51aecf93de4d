"""Whose the submissions of a Gradescope export are: its `submission_metadata.yml`.

The file also holds what the submissions printed, so it is read line by line, and only the few lines that count are.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import yaml

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from course_kit.classroom.intake.layouts import HandIn

METADATA = "submission_metadata.yml"
_LARGEST = 256 * 1024**2  # bytes
_LONGEST = 1000  # characters of a line that counts
_SUBMISSION = re.compile(r"['\"]?(submission_\d{1,18})['\"]?:\s*\Z", re.ASCII)
_KEY = re.compile(r"( {1,8}):(submitters|created_at|\w+): *(.*)\Z", re.ASCII)
_FIELD = re.compile(r"\s*(- +)?:(name|sid|email): *(.*)\Z", re.ASCII)


@dataclass
class Submitter:
    """Somebody who has handed in; what is not known is empty."""

    name: str = ""
    sid: str = ""
    email: str = ""

    @property
    def student(self) -> str:
        """What tells them from the others."""
        return self.sid or self.email or self.name


@dataclass
class _Submission:
    submitters: list[Submitter]
    created: str = ""


def read_submitters(path: Path) -> dict[str, _Submission]:
    """Who has handed in each submission, by the name of its folder; a group has several."""
    found: dict[str, _Submission] = defaultdict(lambda: _Submission([]))
    here: _Submission | None = None
    indent = ""  # of a submission's own keys; whatever a program printed is further in
    in_list = False
    with path.open(encoding="utf-8", errors="replace") as file:
        for line in _lines(file.read(_LARGEST)):
            if match := _SUBMISSION.match(line):
                here, indent, in_list = found[match[1]], "", False
            elif here is None:
                continue
            elif (match := _KEY.match(line)) and match[1] == (indent or match[1]):
                indent = match[1]
                in_list = match[2] == "submitters" and not here.submitters
                if match[2] == "created_at":
                    here.created = here.created or _value(match[3])
            elif in_list and (match := _FIELD.match(line)):
                _note(here, match)
    return dict(found)


def add_submitters(units: Iterable[HandIn], submissions: Mapping[str, _Submission]) -> Iterator[HandIn]:
    """Entries of an export with the names of those who handed them in; a group's entry is one of each member."""
    for unit in units:
        submission = submissions.get(unit.item.name)
        submitters = [submitter for submitter in submission.submitters if submitter.student] if submission else []
        if unit.odd or submission is None or not submitters:
            yield unit
            continue
        group = {"group": unit.item.name} if len(submitters) > 1 else {}
        for submitter in submitters:
            about = {"sid": submitter.sid, "email": submitter.email, "submitted_at": submission.created, **group}
            platform = {**unit.platform, **{key: value for key, value in about.items() if value}}
            yield replace(unit, student=submitter.student, name=submitter.name, platform=platform)


def _lines(text: str) -> Iterator[str]:
    return (line for line in text.split("\n") if len(line) <= _LONGEST)


def _note(submission: _Submission, match: re.Match[str]) -> None:
    if match[1] or not submission.submitters:  # the first line of a member
        submission.submitters.append(Submitter())
    setattr(submission.submitters[-1], match[2], _value(match[3]))


def _value(text: str) -> str:
    """A scalar of YAML as text."""
    try:
        value = yaml.load(text, Loader=yaml.BaseLoader)  # noqa: S506 - makes nothing but texts
    except (yaml.YAMLError, RecursionError):
        return ""
    return value.strip() if isinstance(value, str) else ""

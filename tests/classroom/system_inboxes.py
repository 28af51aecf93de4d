"""Inboxes of sixty students as learning platforms lay them out."""

from __future__ import annotations

import os
import re
import zipfile
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .accidents import FINAL, of_student

if TYPE_CHECKING:
    from pathlib import Path

CLASS_SIZE = 60
_FIRST = ("Jörg", "Ana María", "Li", "Zoë", "Søren", "Miriam", "Ö", "Nguyễn", "Ben", "Chloé")
_LAST = ("Müller", "van der Berg", "O'Neil", "García López", "Smith-Jones", "Na")
DAY_1, DAY_2 = 1_790_000_000, 1_790_086_400
SYSTEMS = ("canvas", "moodle", "moodle flat", "gradescope", "nbgrader", "github", "folders")


@dataclass(frozen=True)
class Person:
    """A student, as several systems know them."""

    number: int

    @property
    def first(self) -> str:
        return _FIRST[self.number % len(_FIRST)]

    @property
    def last(self) -> str:
        return _LAST[self.number // len(_FIRST)]

    @property
    def name(self) -> str:
        return f"{self.first} {self.last}"

    @property
    def login(self) -> str:
        return f"st{self.number:03}"

    @property
    def email(self) -> str:
        return f"{self.login}@uni.example"

    @property
    def canvas(self) -> str:
        return f"{9000 + self.number}"

    @property
    def in_canvas(self) -> str:
        """The name as Canvas's zipper writes it: last name first, small, letters alone."""
        return re.sub(r"\W", "", f"{self.last}, {self.first}".lower())


PEOPLE = tuple(Person(number) for number in range(CLASS_SIZE))


class Maker:
    """Makes the inbox of one system."""

    def __init__(self, system: str, home: Path) -> None:
        self._system = system
        self._files: dict[str, tuple[bytes, int]] = {}
        is_zip = system in ("canvas", "moodle", "moodle flat", "gradescope")
        self.source = home / ("submissions.zip" if is_zip else "inbox")
        for person in PEOPLE:
            self._hand_in(person, of_student(person.number))
        self._add_what_the_system_adds()
        if is_zip:
            self._pack()
        else:
            self._lay_out()

    def _hand_in(self, person: Person, files: dict[str, bytes]) -> None:
        for place, (name, content) in enumerate(files.items()):
            self._files[self._path(person, name, place)] = (content, DAY_2 if name == FINAL else DAY_1)

    def _path(self, person: Person, name: str, place: int) -> str:
        number = 100 + person.number
        if self._system == "canvas":
            late = "LATE_" if person.number % 7 == 0 else ""
            return f"{person.in_canvas}_{late}{person.canvas}_{70000 + 10 * person.number + place}_{name}"
        return {
            "moodle": f"{person.name}_{number}_assignsubmission_file/{name}",
            "moodle flat": f"{person.name}_{number}_assignsubmission_file_{name}",
            "gradescope": f"assignment_4711_export/submission_{5000 + person.number}/{name}",
            "nbgrader": f"submitted/{person.login}/week 3/{name}",
            "github": f"services-submissions/services-{person.login}/{name}",
            "folders": f"{person.email}/{name}",
        }[self._system]

    def _add_what_the_system_adds(self) -> None:
        if self._system == "gradescope":
            self._add("assignment_4711_export/submission_metadata.yml", metadata())
            self._add("__MACOSX/assignment_4711_export/._submission_metadata.yml", "\0")
        for person in PEOPLE:
            if self._system == "nbgrader":
                self._add(f"submitted/{person.login}/week 3/timestamp.txt", "2026-11-01 12:00:00.000000 UTC")
            if self._system == "github":
                self._add(f"services-submissions/services-{person.login}/.git/config", "[core]")
            if self._system == "folders":
                self._add(f"{person.email}/.DS_Store", "")

    def _add(self, path: str, text: str) -> None:
        self._files[path] = (text.encode(), DAY_1)

    def _pack(self) -> None:
        with zipfile.ZipFile(self.source, "w", zipfile.ZIP_DEFLATED) as packed:
            for path, (content, when) in self._files.items():
                day = (2026, 11, 1 if when == DAY_1 else 2, 12, 0, 0)
                member = zipfile.ZipInfo(path, day)
                member.compress_type = zipfile.ZIP_DEFLATED
                packed.writestr(member, content)

    def _lay_out(self) -> None:
        for path, (content, when) in self._files.items():
            target = self.source / path
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
            os.utime(target, (when, when))


def metadata() -> str:
    """Gradescope's file, with what a submission printed in it."""
    entries = []
    for person in PEOPLE:
        entries.append(f"submission_{5000 + person.number}:")
        entries.append("  :submitters:")
        entries.append(f"  - :name: {person.name}")
        entries.append(f"    :sid: '{person.login}'")
        entries.append(f"    :email: {person.email}")
        entries.append("  :created_at: 2026-11-01 12:00:00.000000000 Z")
        entries.append("  :score: 0.0")
        entries.append("  :results:")
        entries.append("    output: |-")
        entries.append("      :submitters:")
        entries.append("      - :name: Mallory")
    return "\n".join(entries) + "\n"

"""The catalogue of diagnoses: for each code what happened, why, how to go on, and where the course teaches it."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

from course_kit import environment

_FILE = Path(__file__).with_name("diagnoses.toml")


@dataclass(frozen=True)
class Diagnosis:
    """One entry.

    Attributes:
        code: its name in reports, `service.no_return`.
        title: what is the matter, in a few words.
        explanation: why that happens.
        hint: names the fix without giving it away.
        notebook: the notebook that teaches it, relative to the course's folder.
        section: the heading there.
    """

    code: str
    title: str
    explanation: str
    hint: str
    notebook: str
    section: str

    @property
    def link(self) -> str:
        """Where to read on; JupyterLab opens it at the heading."""
        return f"{self.notebook}#{self.section.replace(' ', '-')}"


@lru_cache(maxsize=1)
def catalogue() -> dict[str, Diagnosis]:
    """All diagnoses by code."""
    entries = tomllib.loads(_FILE.read_text(encoding="utf-8"))
    return {code: Diagnosis(code, **fields) for code, fields in entries.items()}


def complete(message: str, code: str | None) -> str:
    """What happened in this case, followed by why and by where to read, when the cause is known."""
    if code is None:
        return message
    found = catalogue()[code]
    read_on = f" Read on: {found.link}" if environment.lesson(found.notebook) else ""
    return f"{message} {found.explanation}{read_on}"

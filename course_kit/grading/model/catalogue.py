"""The catalogue of diagnoses: for each code what happened, why, how to go on, and where the course teaches it."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

from course_kit import environment
from course_kit.interfaces.hints import nearest_name

if TYPE_CHECKING:
    from collections.abc import Mapping

_FILE = Path(__file__).parents[1] / "diagnosis" / "diagnoses.toml"


@dataclass(frozen=True)
class Diagnosis:
    """One entry."""

    code: str  # its name in reports, `service.no_return`
    title: str  # what is the matter, in a few words
    explanation: str  # why that happens
    hint: str  # names the fix without giving it away
    notebook: str  # the notebook that teaches it, relative to the course's folder; empty for that of the exercise
    section: str  # the heading there

    @property
    def link(self) -> str:
        """Where to read on; JupyterLab opens it at the heading."""
        return f"{self.notebook}#{self.section.replace(' ', '-')}"


REPLACEABLE = ("title", "explanation", "notebook", "section")
"""What an exercise may word in its own way; hints it has in its ladder."""


@lru_cache(maxsize=1)
def catalogue() -> dict[str, Diagnosis]:
    """All diagnoses by code."""
    entries = tomllib.loads(_FILE.read_text(encoding="utf-8"))
    return {code: Diagnosis(code, **fields) for code, fields in entries.items()}


def reword_diagnosis(code: str, fields: Mapping[str, str]) -> Diagnosis:
    """The entry of a code as an exercise words it."""
    if code not in catalogue():
        near = nearest_name(code, catalogue())
        raise ValueError(f"there is no diagnosis '{code}'{f'; did you mean {near}?' if near else ''}")
    for name, text in fields.items():
        if name not in REPLACEABLE:
            raise ValueError(f"the diagnosis {code} has no '{name}' to set; known are {', '.join(REPLACEABLE)}")
        if not text.strip():
            raise ValueError(f"'{name}' of the diagnosis {code} is empty")
    if "notebook" in fields and "section" not in fields:
        raise ValueError(f"the diagnosis {code} names a notebook without a 'section' of it")
    return replace(catalogue()[code], **fields)


def complete(message: str, found: Diagnosis | None) -> str:
    """What happened in this case, followed by why and by where to read, when the cause is known."""
    if found is None:
        return message
    read_on = f" Read on: {found.link}" if environment.paths.lesson_path(found.notebook) else ""
    return f"{message} {found.explanation}{read_on}"

"""The catalogue of diagnoses: for each code what happened, why, how to go on, and where the course teaches it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import msgspec

from course_kit import environment
from course_kit.interfaces.hints import nearest_name

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


@lru_cache(maxsize=1)
def catalogue() -> dict[str, Diagnosis]:
    """All diagnoses by code."""
    entries = msgspec.toml.decode(_FILE.read_text(encoding="utf-8"))
    return {code: Diagnosis(code, **fields) for code, fields in entries.items()}


class DiagnosisWords(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """What an exercise words in its own way of a diagnosis; hints it has in its ladder."""

    title: str | None = None
    explanation: str | None = None
    notebook: str | None = None
    section: str | None = None

    def require_sense(self, code: str) -> None:
        """See that there is such a diagnosis, and that no text is empty."""
        if code not in catalogue():
            near = nearest_name(code, catalogue())
            raise ValueError(f"there is no diagnosis '{code}'{f'; did you mean {near}?' if near else ''}")
        for name, text in msgspec.to_builtins(self).items():
            if not text.strip():
                raise ValueError(f"'{name}' of the diagnosis {code} is empty")
        if self.notebook and not self.section:
            raise ValueError(f"the diagnosis {code} names a notebook without a 'section' of it")


def complete_message(message: str, found: Diagnosis | None) -> str:
    """What happened in this case, followed by why and by where to read, when the cause is known."""
    if found is None:
        return message
    read_on = f" Read on: {found.link}" if environment.paths.lesson_path(found.notebook) else ""
    return f"{message} {found.explanation}{read_on}"

"""The task of an exercise, sentence by sentence, as its exercise.toml holds it.

Learners read these texts in the notebook and in the starter; checks name the sentences they prove by their ids.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

_IDENTIFIER = re.compile(r"[a-z][a-z0-9_]*\Z")


@dataclass(frozen=True)
class Sentence:
    """One thing that a learner is told."""

    id: str  # its name, which checks refer to
    text: str  # in Markdown, one or more sentences that are tested together, or a row of a table (`| a | b |`)
    heading: str = ""  # begins a new paragraph with these words; above a row of a table the header of a new table
    # the id of the notebook's cell in which it and those after it stand; that of the one before when empty
    cell: str = ""
    freedom: str = ""  # for a sentence that grants a freedom, the right program of the proof set that makes use of it

    @property
    def is_row(self) -> bool:
        """Whether it is a row of a table."""
        return self.text.startswith("|")


def read(tables: object) -> tuple[Sentence, ...]:
    """The sentences out of the `[[sentences]]` of an exercise.toml."""
    if not isinstance(tables, list):
        raise ValueError("'sentences' has to be written as [[sentences]]")  # noqa: TRY004 - a file's mistakes are all of one kind
    found = [_sentence(table) for table in tables]
    ids = [one.id for one in found]
    if doubles := sorted({name for name in ids if ids.count(name) > 1}):
        raise ValueError(f"two sentences have the id '{doubles[0]}'")
    return tuple(found)


def _sentence(table: object) -> Sentence:
    if not isinstance(table, dict) or not all(isinstance(value, str) for value in table.values()):
        raise ValueError("a sentence is a table of texts")
    if unknown := sorted(set(table) - set(Sentence.__dataclass_fields__)):
        raise ValueError(f"a sentence has no field '{unknown[0]}'; it has {', '.join(Sentence.__dataclass_fields__)}")
    name = table.get("id", "")
    if not _IDENTIFIER.match(name):
        raise ValueError(f"the sentence '{table.get('text', name)}' needs an 'id' of small letters, digits and _")
    if not table.get("text", "").strip():
        raise ValueError(f"the sentence '{name}' has no 'text'")
    return Sentence(**{key: value.strip() for key, value in table.items()})

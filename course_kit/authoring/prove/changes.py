"""Changes to a program's text."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, order=True)
class Edit:
    """The text from `start` to `end`, in characters, replaced by another."""

    start: int
    end: int
    text: str


@dataclass(frozen=True)
class Mutation:
    """One mistake.

    Attributes:
        operator: what kind of mistake.
        line: where, from 1.
        edits: what it replaces.
    """

    operator: str
    line: int
    edits: tuple[Edit, ...]

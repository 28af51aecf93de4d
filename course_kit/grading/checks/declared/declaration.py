"""A declared check as it was read: plain data, which travels to the grader process."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from course_kit.grading.plain_data import rebuilt

if TYPE_CHECKING:
    from collections.abc import Mapping

    from course_kit.grading.plain_data import Record


@dataclass(frozen=True)
class WantedEndpoint:
    """One of the exercise's `[[endpoints]]`.

    Attributes:
        kind: "service", "action", "publisher" or "subscription", from the submission's side.
        name: its full name.
        type: the full name of its interface.
    """

    kind: str
    name: str
    type: str


@dataclass(frozen=True)
class Declaration:
    """One check of an exercise.toml, without mistakes.

    Attributes:
        id: its name in reports.
        kind: one of `kinds.KINDS`.
        title: one line for the learner.
        points: what it is worth.
        deadline_s: seconds for all its waiting together.
        depends_on: ids of checks without which it makes no sense.
        proves: ids of the sentences of the task that it proves.
        endpoints: what its keys name, by these keys; for "offered" by their names.
        node: the full name of the node, where it needs one.
        keys: what else its table says.
    """

    id: str
    kind: str
    title: str
    points: float
    deadline_s: float
    depends_on: tuple[str, ...] = ()
    proves: tuple[str, ...] = ()
    endpoints: Mapping[str, WantedEndpoint] = field(default_factory=dict)
    node: str = ""
    keys: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def from_record(cls, record: Record) -> Declaration:
        """The declaration of which `dataclasses.asdict` has made a record."""
        made = rebuilt(cls, {**record, "endpoints": {}})
        endpoints = {key: WantedEndpoint(**one) for key, one in record["endpoints"].items()}
        return cls(**{**vars(made), "endpoints": endpoints})

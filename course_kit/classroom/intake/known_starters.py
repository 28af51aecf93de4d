"""All starters that the course ever gave out: whoever hands one in as it was has not begun with the exercise.

`known_starters.json` is written by `python -m course_kit.authoring.shipped_starters` out of git's history: an old
starter comes back from those who cloned the course a year ago.
"""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.grading import exercise_folders
from course_kit.reader import fingerprints, text

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from course_kit.grading.exercise import Exercise

FILE = Path(__file__).with_name("known_starters.json")


def read(path: Path = FILE) -> dict[str, frozenset[str]]:
    """For each exercise the identities of its starters, see `course_kit.reader.fingerprints.identity`."""
    table = json.loads(path.read_text(encoding="utf-8"))
    return {str(name): frozenset(map(str, identities)) for name, identities in table.items()}


def of(task: Exercise, known: Mapping[str, frozenset[str]]) -> frozenset[str]:
    """The identities of an exercise's starters."""
    if not exercise_folders.is_added(task.folder):
        return known.get(task.id, frozenset())
    return frozenset(_identities(task))


def _identities(task: Exercise) -> Iterator[str]:
    for name in (task.starter, task.notebook):
        # One that is not there, or a notebook without a cell to fill in, was given to nobody.
        with suppress(OSError, text.UnreadableTextError), (task.folder / name).open("rb") as file:
            yield fingerprints.identity(text.program(name, file, task.id)[0])

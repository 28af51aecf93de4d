"""Renews the list of all starters the course ever gave out: `python -m course_kit.authoring.shipped_starters`.

A class run tells by it whether somebody has handed in a starter as it was. What the list holds already stays in it. A
test says when this was forgotten.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from course_kit.classroom.intake import known_starters
from course_kit.grading import exercise
from course_kit.reader import fingerprints, text

if TYPE_CHECKING:
    from pathlib import Path


def renew(target: Path, root: Path) -> dict[str, list[str]]:
    """Add the starters of a course's exercises to a list; returns it, for each exercise its identities."""
    found = known_starters.read(target) if target.is_file() else {}
    table = {name: set(identities) for name, identities in found.items()}
    for task in (exercise.load(name, root / "exercises") for name in exercise.ids(root / "exercises")):
        for name in (task.starter, task.notebook):
            with (task.folder / name).open("rb") as file:
                source, _ = text.program(name, file, task.id)
            table.setdefault(task.id, set()).add(fingerprints.identity(source))
    result = {name: sorted(identities) for name, identities in sorted(table.items())}
    target.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return result


if __name__ == "__main__":
    for identifier, known in renew(known_starters.FILE, exercise.exercises_folder().parent).items():
        print(f"{identifier}: {len(known)} starters")

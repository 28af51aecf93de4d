"""What a class run notes about itself in the folder of its results, so that others can go on with it: `run.json`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit.environment import write_atomically
from course_kit.grading import exercise, exercise_folders
from course_kit.grading.errors import GradingError
from course_kit.text.sanitize import encodable

if TYPE_CHECKING:
    from course_kit.classroom.run import Plan
    from course_kit.grading.exercise import Exercise

FILE = "run.json"
FORMAT_VERSION = 1


def write(plan: Plan, seed: int) -> None:
    """Note a run."""
    added = {one.id: str(one.folder.resolve()) for one in plan.exercises if exercise_folders.is_added(one.folder)}
    folders = {**_noted_folders(plan.out), **added}
    noted = {"format_version": FORMAT_VERSION, "seed": seed, "exercise_folders": folders}
    write_atomically(plan.out / FILE, f"{encodable(json.dumps(noted))}\n")


def read(out: Path) -> dict[str, Any]:
    """What the run that has written into a folder has noted; empty where there was none, or it cannot be read."""
    try:
        noted = json.loads((out / FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return noted if isinstance(noted, dict) else {}


def seed_of(out: Path) -> int | None:
    """The seed a run has noted; None if there was none."""
    try:
        return int(read(out)["seed"])
    except (ValueError, KeyError, TypeError):
        return None


def exercise_of(out: Path, exercise_id: str) -> Exercise:
    """An exercise of the run that has written into a folder: as it is known now, else where the run has found it."""
    noted = _noted_folders(out).get(exercise_id)
    if noted is None or exercise_id in exercise_folders.find().folders:
        return exercise.load(exercise_id)
    if not Path(noted).is_dir():
        raise GradingError(
            f"The exercise {exercise_id} was in {noted}, and is not there any more. Name its folder with --exercises."
        )
    return exercise.read(Path(noted))


def _noted_folders(out: Path) -> dict[str, Any]:
    folders = read(out).get("exercise_folders")
    return folders if isinstance(folders, dict) else {}

"""The list of starters: whole, and nobody who has not begun is taken for somebody who has."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import pytest

from course_kit.authoring import shipped_starters
from course_kit.classroom.intake import known_starters
from course_kit.grading import exercise
from course_kit.reader import fingerprints, text

if TYPE_CHECKING:
    from pathlib import Path

IDS = exercise.ids()


@pytest.mark.parametrize("exercise_id", IDS)
def test_the_starters_of_today_are_on_the_list(exercise_id: str) -> None:
    task = exercise.load(exercise_id)
    for name in (task.starter, task.notebook):
        with (task.folder / name).open("rb") as file:
            source, _ = text.program(name, file, task.id)
        assert fingerprints.identity(source) in known_starters.read()[task.id], (
            "run python -m course_kit.authoring.shipped_starters"
        )


def test_a_starter_of_last_year_stays_on_the_list(tmp_path: Path) -> None:
    folder = tmp_path / "exercises/temperature_service"
    folder.mkdir(parents=True)
    task = exercise.load("temperature_service")
    for name in ("exercise.toml", task.starter, task.notebook):
        (folder / name).write_bytes((task.folder / name).read_bytes())
    target = tmp_path / "list.json"
    old = shipped_starters.renew(target, tmp_path)["temperature_service"]
    (folder / task.starter).write_text("class OfThisYear:\n    pass\n")
    new = fingerprints.identity("class OfThisYear:\n    pass\n")
    assert set(shipped_starters.renew(target, tmp_path)["temperature_service"]) == {*old, new}
    assert known_starters.read(target)["temperature_service"] >= {*old, new}


@pytest.mark.parametrize(
    ("change", "same"),
    [
        (lambda source: source.replace("\n", "\r\n"), True),
        (lambda source: f"# Jane Doe\n\n{source}\n\n", True),
        (lambda source: source.replace("    ", "\t"), True),
        (lambda source: source.replace("TemperatureService", "TemperatureServer"), False),
        (lambda source: f"{source}\nx = 1\n", False),
    ],
)
def test_comments_and_blanks_change_no_program(change: object, same: bool) -> None:
    task = exercise.load("temperature_service")
    starter = (task.folder / task.starter).read_text()
    changed = io.BytesIO(change(starter).encode())  # type: ignore[operator]
    source, _ = text.program(task.starter, changed, task.id)
    assert (fingerprints.identity(source) in known_starters.read()[task.id]) is same

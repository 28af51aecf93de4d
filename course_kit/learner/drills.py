"""`course-kit drills`: small repairs for practice, which count for nothing; and how to begin one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading import exercise
from course_kit.grading.errors import GradingError
from course_kit.learner import course_list, starters, workspace
from course_kit.ros.names import did_you_mean
from course_kit.text.console import wrapped

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading.exercise import Exercise
    from course_kit.learner.course_list import Row

_INDENT = " " * 4


def listed(encoding: str | None, folder: Path | None = None) -> tuple[str, list[str]]:
    """All drills with their symptoms, a tick for each that is done, and what to tell the user about unusable files."""
    rows, told = course_list.rows(folder, practice=True)
    lines = ["Small repairs, five to ten minutes each: practice without points.", ""]
    for row in rows:
        lines += _lines(row, course_list.tick(encoding))
    lines += ["", f"{sum(row.known.passed for row in rows)} of {len(rows)} done."]
    following = next((row.task.id for row in rows if not row.known.passed), None)
    if following is not None:
        lines.append(f"Next: {environment.command()} drills {following}")
    return "\n".join(lines), told


def begin(drill_id: str, folder: Path | None = None) -> str:
    """What a drill is about, and how to work on it; its program is put where it belongs if it is not there."""
    task = _drill(drill_id, folder)
    place = workspace.exercise_folder(task) if folder is None else task.folder
    if place is None:
        raise workspace.no_files_of(task, "watch")
    for missing in starters.changed(task, place):
        if not missing.file.exists():
            missing.carry_out()
    command, program = environment.command(), workspace.shown(place / task.starter)
    return "\n".join(
        [
            *wrapped(f"Drill {task.order}: {task.title}", "", _INDENT),
            "",
            *wrapped(task.symptom),
            "",
            f"The program:     {program}",
            f"In a notebook:   {workspace.shown(place / task.notebook)}",
            f"While you work:  {command} watch {task.id}",
            f"Is it done?      {command} grade {task.id} {program}",
            f"A hint:          {command} hint {task.id}",
            f"Start again:     {command} reset {task.id}",
        ]
    )


def _drill(drill_id: str, folder: Path | None) -> Exercise:
    rows, _ = course_list.rows(folder, practice=True)
    found = {row.task.id: row.task for row in rows}
    if drill_id in found:
        return found[drill_id]
    if drill_id in exercise.ids(folder):
        raise GradingError(f"{drill_id} is an exercise, not a drill. See {environment.command()} list.")
    guess = did_you_mean(drill_id, found)
    raise GradingError(f"There is no drill '{drill_id}'.{guess} There are: {', '.join(found) or 'none'}.")


def _lines(row: Row, tick: str) -> list[str]:
    mark = tick if row.known.passed else " "
    head = f"[{mark}] {row.task.order} {row.task.id}" + (": done" if row.known.passed else "")
    return [head, *wrapped(row.task.symptom, _INDENT, _INDENT)]

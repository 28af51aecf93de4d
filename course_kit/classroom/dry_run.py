"""Looks at what was handed in and grades nothing: which file would be graded for whom, and why."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.classroom.intake import collecting, table
from course_kit.classroom.preconditions import WORKSPACE, require_folders_apart
from course_kit.grading.reading import ReadingStoppedError
from course_kit.grading.readings import Readings

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.classroom.intake.collecting import Intake
    from course_kit.classroom.run import Plan


def look(plan: Plan, stopped: Callable[[], bool] = lambda: False) -> Intake:
    """Find the submissions and write their table into the output folder; nothing else is written there."""
    require_folders_apart(plan.sources, plan.out)
    with tempfile.TemporaryDirectory(prefix="course-kit-intake-") as folder:
        try:
            found = collecting.collect(
                plan.sources, plan.exercises, Path(folder) / WORKSPACE, plan.layout, Readings(stopped), plan.roster
            )
        except ReadingStoppedError:
            raise KeyboardInterrupt from None
        table.write(found, plan.out)
    return found

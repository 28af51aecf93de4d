"""Renews the pristine starters that `course-kit reset` puts back: `python -m course_kit.authoring.pristine`.

Run it after a change to the starter or the notebook of an exercise; a test says when it was forgotten. It renews the
list of all starters ever given out, too (`shipped_starters`).
"""

from __future__ import annotations

import shutil
import sys
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.authoring import shipped_starters
from course_kit.grading import exercise
from course_kit.learner import workspace

if TYPE_CHECKING:
    from pathlib import Path


def renew(target: Path, folder: Path | None = None) -> list[Path]:
    """Copy the starters of all exercises to `target`, and return what was written; nothing else stays there."""
    tasks = [exercise.load(name, folder) for name in exercise.ids(folder)]
    files = [task.folder / name for task in tasks for name in (task.starter, task.notebook)]
    contents = {target / file.parent.name / f"{file.name}{workspace.PRISTINE}": file.read_bytes() for file in files}
    shutil.rmtree(target, ignore_errors=True)  # only now, when all could be read
    for path, content in contents.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return list(contents)


def main() -> int:
    """Renew those of the package."""
    for path in renew(workspace.STARTERS):
        print(path.relative_to(environment.PACKAGE))
    return shipped_starters.main()


if __name__ == "__main__":
    sys.exit(main())

"""Renews the pristine starters: `python -m course_kit.authoring.pristine [EXERCISE ...]`.

`course-kit reset` puts them back, and `course-kit release` gives them to students, whatever stands in `exercises/`.
Run it after a change to the starter or the notebook of an exercise; a test says when it was forgotten. It renews the
list of all starters ever given out, too (`shipped_starters`).
"""

from __future__ import annotations

import shutil
import sys
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.authoring import shipped_starters
from course_kit.grading import exercise, exercise_folders
from course_kit.grading.errors import GradingError
from course_kit.learner import workspace
from course_kit.text.console import cannot

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


def renew(target: Path, folder: Path | None = None, chosen: Sequence[str] = ()) -> list[Path]:
    """Copy starters of exercises to `target`.

    Args:
        target: the folder of pristine starters.
        folder: the folder of exercises, the course's own when None.
        chosen: ids of the exercises; all when none is named, and then nothing else stays in `target`.

    Returns:
        what was written.

    Raises:
        GradingError: there is no such exercise.
        OSError: a file cannot be read or written.
    """
    names = chosen or [*exercise.ids(folder), *exercise_folders.drills(folder)]
    tasks = [exercise.load(name, folder) for name in names]
    files = [task.folder / name for task in tasks for name in (task.starter, task.notebook)]
    contents = {target / file.parent.name / f"{file.name}{workspace.PRISTINE}": file.read_bytes() for file in files}
    for old in [target / task.id for task in tasks] if chosen else [target]:
        shutil.rmtree(old, ignore_errors=True)  # only now, when all could be read
    for path, content in contents.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return list(contents)


def main(arguments: Sequence[str]) -> int:
    """Renew those of the package: of the exercises that are named, else of all."""
    try:
        written = renew(workspace.STARTERS, chosen=arguments)
    except GradingError as problem:
        return cannot(problem)
    except OSError as problem:
        return cannot(f"{problem.filename} could not be copied: {problem.strerror}.")
    for path in written:
        print(path.relative_to(environment.PACKAGE))
    return shipped_starters.main()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

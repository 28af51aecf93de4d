"""Renews the pristine starters that `course-kit reset` puts back: `python -m course_kit.dev.starters`.

Run it after a change to the starter or the notebook of an exercise; a test says when it was forgotten.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from course_kit import shelf
from course_kit.grading import exercise


def renew(target: Path, folder: Path | None = None) -> list[Path]:
    """Copy the starters of all exercises to `target`, and return what was written; nothing else stays there."""
    shutil.rmtree(target, ignore_errors=True)
    written = []
    for name in exercise.ids(folder):
        task = exercise.load(name, folder)
        (target / name).mkdir(parents=True)
        for file in (task.starter, task.notebook):
            written.append(target / name / f"{file}{shelf.PRISTINE}")
            written[-1].write_bytes((task.folder / file).read_bytes())
    return written


def main() -> int:
    """Renew those of the package."""
    for path in renew(shelf.STARTERS):
        print(path.relative_to(Path(__file__).parent.parent))
    return 0


if __name__ == "__main__":
    sys.exit(main())

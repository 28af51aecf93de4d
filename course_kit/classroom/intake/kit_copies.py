"""Copies of this course in what somebody has handed in, such as a fork: the course's own programs are nobody's work."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Iterable

REASON = "a part of the course kit"
_PACKAGE = "course_kit/__init__.py"
_EXERCISE = re.compile(r"exercises/[^/]+/exercise\.toml")
_FOLDERS = ("course_setup/", "solutions/", "tests/", "benchmarks/", "notebooks/demos/")
_MOST = 10  # copies in one student's work that are looked for
_LESSON = re.compile(r"notebooks/\d\d_\w+\.ipynb")


def parts(paths: Iterable[str]) -> set[str]:
    """Those of a student's files that came with the course; the folder of exercises is where students work."""
    all_paths = list(paths)
    packages = [path.removesuffix(_PACKAGE) for path in all_paths if f"/{path}".endswith(f"/{_PACKAGE}")]
    found: set[str] = set()
    for root in packages[:_MOST]:
        below = [(path, path[len(root) :]) for path in all_paths if path.startswith(root)]
        whole = any(_EXERCISE.fullmatch(inside) for _, inside in below)
        found.update(path for path, inside in below if _is_the_kits(inside, whole=whole))
    return found


def _is_the_kits(path: str, *, whole: bool) -> bool:
    if path.startswith("course_kit/"):
        return True
    path = path.removeprefix(f"{environment.LEARNER_FOLDER}/")  # `./course lab` copies lessons there
    return whole and (path.startswith(_FOLDERS) or _LESSON.fullmatch(path) is not None or path == "hatch_build.py")

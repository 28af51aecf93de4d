"""Renews the list of all starters the course ever gave out: `python -m course_kit.authoring.shipped_starters`.

A class run tells by it whether somebody has handed in a starter as it was. What git still knows is read, and what the
list holds already stays in it, so that a clone without its history loses nothing. A test says when it was forgotten;
`python -m course_kit.authoring.pristine` renews it, too.
"""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.classroom.intake import known_starters
from course_kit.grading import exercise
from course_kit.reader import fingerprints, text

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_STARTER = re.compile(
    r"(?:exercises|course_kit/starters)/(?P<exercise>\w+)/(?P<name>[^/]+\.(?:py|ipynb))(?:\.pristine)?"
)
_OF_GIT_S = 60.0


def renew(target: Path, root: Path) -> dict[str, list[str]]:
    """Write the list, and return it: for each exercise the identities of its starters.

    Args:
        target: the list's file.
        root: the course's folder.
    """
    found = known_starters.read(target) if target.is_file() else {}
    table = {name: set(identities) for name, identities in found.items()}
    for task in (exercise.load(name, root / "exercises") for name in exercise.ids(root / "exercises")):
        for name in (task.starter, task.notebook):
            _add(table, task.id, name, (task.folder / name).read_bytes())
    for task_id, name, content in _of_history(root):
        _add(table, task_id, name, content)
    result = {name: sorted(identities) for name, identities in sorted(table.items())}
    target.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    return result


def _add(table: dict[str, set[str]], task_id: str, name: str, content: bytes) -> None:
    try:
        source, _ = text.program(name, io.BytesIO(content), task_id)
    except text.UnreadableTextError:
        return  # a notebook of another exercise, or of a time before it had a marked cell
    table.setdefault(task_id, set()).add(fingerprints.identity(source))


def _of_history(root: Path) -> Iterator[tuple[str, str, bytes]]:
    """Exercise, file name and content of each starter that git knows, every version once; none without git."""
    seen: set[str] = set()
    for commit in _git(root, "log", "--format=%H", "--", "exercises", "course_kit/starters").split():
        tree = _git(root, "ls-tree", "-r", commit.decode(), "exercises", "course_kit/starters")
        for line in tree.decode(errors="replace").splitlines():
            about, _, path = line.partition("\t")
            blob, match = about.split()[-1], _STARTER.fullmatch(path)
            if match and blob not in seen:
                seen.add(blob)
                yield match["exercise"], match["name"], _git(root, "cat-file", "blob", blob)


def _git(root: Path, *command: str) -> bytes:
    """What git says; nothing where it is not there, or this is no clone."""
    try:
        ended = subprocess.run(["git", *command], cwd=root, capture_output=True, timeout=_OF_GIT_S, check=False)
    except FileNotFoundError:
        return b""
    return ended.stdout if ended.returncode == 0 else b""


def main() -> int:
    """Renew the one of the package."""
    root = exercise.exercises_folder().parent
    for name, identities in renew(known_starters.FILE, root).items():
        print(f"{name}: {len(identities)} starters")
    print(known_starters.FILE.relative_to(environment.PACKAGE))
    return 0


if __name__ == "__main__":
    sys.exit(main())

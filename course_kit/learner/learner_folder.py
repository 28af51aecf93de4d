"""A learner's folder: lessons and exercises to work in, made from a course and brought up to date with it.

A manifest in it says what was handed out. So an update replaces what the learner has not changed, leaves what they
have, with the new version beside it, and brings back nothing that they have deleted, unless there is a new version.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from course_kit import environment
from course_kit.learner import handed_out

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

BESIDE = "new-version"
_FORMAT_VERSION = 1


@dataclass
class Update:
    """What was done to a learner's folder."""

    renewed: list[str] = field(default_factory=list)
    beside: dict[str, str] = field(default_factory=dict)
    removed: list[str] = field(default_factory=list)

    def sentences(self) -> list[str]:
        """What to tell the learner; nothing where nothing of theirs is concerned."""
        told = []
        if self.renewed:
            told.append(f"New version of {_listed(self.renewed)}; you had not changed the old one.")
        if self.beside:
            pairs = [f"{path} as {new}" for path, new in self.beside.items()]
            told.append(
                f"You have changed files that have a new version. Yours stay; the new version of {_listed(pairs)}."
            )
        if self.removed:
            told.append(f"The course no longer has {_listed(self.removed)}; you had not changed it, so it is gone.")
        return told


def update(folder: Path, course: Mapping[str, bytes], *, restore: bool = False) -> Update:
    """Bring a learner's folder up to date, or make it."""
    known = _read_manifest(folder)
    done = Update()
    for path, content in course.items():
        if restore and not (folder / path).exists():
            environment.write_atomically(folder / path, content, durable=False)
        else:
            _update_file(folder, path, content, known.get(path), done)
    gone = known.keys() - course.keys()
    there = {_top(path) for path in course}
    for path in sorted(path for path in gone if _top(path) in there):  # all lessons gone: for a moment, by an accident
        if handed_out.digest_of(folder / path) == known[path]:
            (folder / path).unlink()
            done.removed.append(path)
    given = {path: handed_out.digest(path, content) for path, content in course.items()}
    # What the course no longer has and the learner has changed: should it come back, it is no new version.
    given |= {path: known[path] for path in gone if (folder / path).exists()}
    if given != known:
        manifest = {"format_version": _FORMAT_VERSION, "handed_out": given}
        environment.write_atomically(folder / environment.paths.MANIFEST, f"{json.dumps(manifest, indent=1)}\n")
    return done


def _update_file(folder: Path, path: str, content: bytes, given: str | None, done: Update) -> None:
    """One file: `given` is the hash of what the learner got last, None if they never got it."""
    file = folder / path
    new, theirs = handed_out.digest(path, content), handed_out.digest_of(file)
    if theirs is None:
        if given != new:
            environment.write_atomically(file, content, durable=False)
            done.renewed += [path] if given else []
    elif theirs == new:
        before = file.read_bytes()
        if path.endswith(".ipynb") and (after := handed_out.of_this_python(before)) != before:
            environment.write_atomically(file, after)
    elif theirs == given:
        environment.write_atomically(file, content)
        done.renewed.append(path)
    elif new != given:
        done.beside[path] = _lay_beside(file, content)


def _lay_beside(file: Path, content: bytes) -> str:
    """Write a new version beside a learner's file; returns its name. Another one that they changed stays, too."""
    number, name = 1, f"{file.stem}.{BESIDE}{file.suffix}"
    while handed_out.digest_of(file.with_name(name)) not in (None, handed_out.digest(name, content)):
        number += 1
        name = f"{file.stem}.{BESIDE}-{number}{file.suffix}"
    environment.write_atomically(file.with_name(name), content)
    return name


def _read_manifest(folder: Path) -> dict[str, str]:
    """By path the hash of what was handed out; empty where nobody knows."""
    try:
        content: Any = json.loads((folder / environment.paths.MANIFEST).read_bytes())
        found = content["handed_out"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return {}
    if not isinstance(found, dict):
        return {}
    return {path: value for path, value in found.items() if isinstance(value, str) and _is_inside(path)}


def _top(path: str) -> str:
    return path.partition("/")[0]


def _is_inside(path: str) -> bool:
    """Whether a path of a manifest, which anybody may have written, stays in its folder."""
    return not path.startswith("/") and ".." not in path.split("/")


def _listed(names: list[str]) -> str:
    return ", ".join(names)

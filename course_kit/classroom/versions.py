"""What graded a submission: the kit, the exercise and its grader, as versions and fingerprints of their sources.

Two results with the same three were graded by the same rules.
"""

from __future__ import annotations

import ast
import hashlib
import importlib.util
from importlib import metadata
from importlib.machinery import PathFinder
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import grading, ros
from course_kit.grading import exercise_folders

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from course_kit.grading.exercise import Exercise

_DISTRIBUTION = "ros2-course-kit"
_DIGITS = 12  # hexadecimal
_SOURCES = (".py", ".toml")
_SOURCES_BESIDE = (*_SOURCES, ".msg", ".srv", ".action")
_SHARED = ("course_kit.grading", "course_kit.ros", "course_kit.environment", "course_kit.text")  # in `kit`, or no rules


def of(exercise: Exercise) -> dict[str, str]:
    """`kit`, `exercise` and `grader` of an exercise as they are now."""
    try:
        version = metadata.version(_DISTRIBUTION)
    except metadata.PackageNotFoundError:  # run from its folder
        version = "0"
    folders = [Path(str(package.__file__)).parent for package in (grading, ros)]
    kit = sorted(path for folder in folders for path in folder.rglob("*") if path.suffix in _SOURCES)
    return {
        "kit": f"{version}+{_fingerprint(kit)}",
        "exercise": _fingerprint([exercise.folder / "exercise.toml"]),
        "grader": _fingerprint(_sources_of(exercise)),
    }


def _fingerprint(paths: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for path in paths:
        digest.update(f"{path.name}\0".encode(errors="surrogateescape"))
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:_DIGITS]


def _sources_of(exercise: Exercise) -> list[Path]:
    """The files of an exercise's grader; one in the exercise's folder may use all that lies there, the solution too."""
    if exercise.grader and not Path(exercise.grader).is_absolute():
        return _grader_sources(exercise.grader)
    apart = {exercise.folder / exercise.starter, exercise.folder / exercise_folders.PROOF}
    found = (path for path in exercise.folder.rglob("*") if path.suffix in _SOURCES_BESIDE and path.is_file())
    return sorted(path for path in found if not apart & {path, *path.parents})


def _grader_sources(module: str) -> list[Path]:
    """The files of a grader: its module or package, and what it imports of what is beside it, such as the quiz."""
    around, top = module.rpartition(".")[0], module.partition(".")[0]
    found: dict[str, Path] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        path = _file_of(name)
        if name in found or path is None:
            continue
        found[name] = path
        own = [one for one in _imported(path) if one.startswith(f"{top}.") and one != around]
        waiting += [one for one in own if not one.startswith(_SHARED)]
    packages = [path.parent for path in found.values() if path.name == "__init__.py"]
    inside = {path for folder in packages for path in folder.rglob("*") if path.suffix in _SOURCES}
    return sorted({*found.values(), *inside})


def _file_of(module: str) -> Path | None:
    """The source of a module, found without importing it, or a package it lies in: a grader's would bring rclpy."""
    top, *inner = module.split(".")
    try:
        spec = importlib.util.find_spec(top)
    except (ImportError, ValueError):
        return None
    name = top
    for part in inner:
        if spec is None or spec.submodule_search_locations is None:
            return None
        name = f"{name}.{part}"
        spec = PathFinder.find_spec(name, spec.submodule_search_locations)
    path = Path(spec.origin) if spec and spec.origin else None
    return path if path is not None and path.suffix == ".py" else None


def _imported(path: Path) -> Iterator[str]:
    """Names that may be modules, from a file's imports."""
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)

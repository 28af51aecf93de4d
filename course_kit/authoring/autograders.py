"""What an instructor uploads for grading at a platform: the kit with the scripts that the platform starts."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.authoring.edition_plan import carried_files
from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import load_exercise

if TYPE_CHECKING:
    from collections.abc import Iterator

_TEMPLATES = Path(__file__).with_name("templates")
_FOR_EXERCISE, _FOR_OPTIONS = "@EXERCISE@", "@OPTIONS@"  # in a template: the exercise's id; an option or nothing
_KIT = "ros2-course"  # the kit's folder, in a zip
# What a bare server needs to grade; no solutions or tests. Reports name the lessons that are there.
_PARTS = (
    "course",
    "course_kit",
    "course_setup",
    "exercises",
    "notebooks",
    "pyproject.toml",
    "hatch_build.py",
    "README.md",
    "LICENSE",
)
_NOT_THESE = {"__pycache__", ".ipynb_checkpoints", "demos"}
_NOT_SUCH = (".pyc", ".so", ".tmp")
_EXECUTABLE, _ORDINARY = 0o100755, 0o100644
_RUNTIME = {"runs-on": "ubuntu-24.04", "python": "3.12"}  # what a Classroom 50 assignment is set to


def write_gradescope(exercise_id: str, target: Path, seed: int | None = None) -> Path:
    """Write the zip for "Configure Autograder" in Gradescope: `setup.sh`, `run_autograder` and the kit."""
    files = [*_scripts(exercise_id, seed, "gradescope", "setup.sh", "run_autograder"), *_kit(exercise_id)]
    if target.exists():
        raise GradingError(f"{target} already exists. Choose a new name.")
    environment.write_atomically(target, _zip_executables(files))
    return target


def write_classroom50(exercise_id: str, target: Path, seed: int | None = None) -> Path:
    """Write the folder `autograders/ASSIGNMENT` of Classroom 50: `autograder.py` and the kit beside it."""
    scripts = list(_scripts(exercise_id, seed, "classroom50", "autograder.py"))
    kit = _zip_executables(list(_kit(exercise_id)))
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise GradingError(f"{target} already exists. Choose a new folder.")
    for name, content, _ in scripts:
        environment.write_atomically(target / name, content)
    environment.write_atomically(target / "kit.zip", kit)
    environment.write_atomically(target / "runtime.json", json.dumps(_RUNTIME, indent=2) + "\n")
    return target


def _scripts(exercise_id: str, seed: int | None, platform: str, *names: str) -> Iterator[tuple[str, bytes, int]]:
    exercise = load_exercise(exercise_id)
    for name in names:
        text = (_TEMPLATES / platform / f"{name}.in").read_text(encoding="utf-8")
        options = "" if seed is None else f"--seed={seed}"
        filled_in = text.replace(_FOR_EXERCISE, exercise.id).replace(_FOR_OPTIONS, options)
        yield name, filled_in.encode(), _EXECUTABLE


def _kit(exercise_id: str) -> Iterator[tuple[str, bytes, int]]:
    """Name, content and mode of each file of the kit that grading an exercise needs."""
    prefix = f"{_KIT}/"
    root = environment.checkout_folder()
    if root is None:
        raise GradingError("An autograder is made from the course's folder. Run ./course export there.")
    exercise = load_exercise(exercise_id)
    if exercise_folders.is_added(exercise.folder):  # its files are not among those of the kit
        for name, path in carried_files(exercise).items():
            yield f"{prefix}{name}", path.read_bytes(), _ORDINARY
    for part in _PARTS:
        top = root / part
        for path in sorted(top.rglob("*")) if top.is_dir() else [top]:
            inside = path.relative_to(root)
            if path.is_file() and not _NOT_THESE & set(inside.parts) and path.suffix not in _NOT_SUCH:
                mode = _EXECUTABLE if path.stat().st_mode & 0o100 else _ORDINARY
                yield f"{prefix}{inside.as_posix()}", path.read_bytes(), mode


def _zip_executables(files: list[tuple[str, bytes, int]]) -> bytes:
    """A zip that keeps what is executable, and is the same for the same files."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, content, mode in files:
            entry = zipfile.ZipInfo(name)
            entry.create_system = 3  # Unix, without which nobody looks at the mode
            entry.external_attr = mode << 16
            archive.writestr(entry, content, zipfile.ZIP_DEFLATED)
    return stream.getvalue()

"""The rules of the house, as far as a tool can tell them."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parent.parent
# Lowest first; a room imports only from rooms above it in this list. `autoload` and `__init__` are the doors.
FLOORS = [
    {"environment", "reader"},
    {"interfaces"},
    {"lab", "robot", "quiz", "launch_shim"},
    {"trace", "panels", "ros2", "grading"},
    {"graders"},
    {"magics", "grade_magics", "hint_magic", "cli", "doctor", "jupyter", "dev", "release"}
    | {"progress", "hints", "course_list", "shelf", "watch", "class_cli", "present", "nbgrader", "otter", "__main__"}
    | {"workspace", "discovery_trial", "terminals", "jupyter_folders", "server_extension", "streams"},
]
MAY_NOT_MEET = {("grading", "lab"), ("grading", "panels"), ("graders", "lab"), ("graders", "panels")}


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", *command], cwd=REPOSITORY, capture_output=True, text=True, timeout=300, check=False
    )


@pytest.mark.timeout(300)
def test_mypy_strict_is_content() -> None:
    done = run("mypy", "-p", "course_kit")
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("command", [("check", "."), ("format", "--check", ".")])
def test_ruff_is_content(command: tuple[str, ...]) -> None:
    done = run("ruff", *command)
    assert done.returncode == 0, done.stdout


def room_of(module: str) -> str:
    return module.split(".")[1] if "." in module else ""


def imports(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level == 0 and (node.module or "").split(".")[0] == "course_kit":
            module = str(node.module)
            found |= {f"course_kit.{alias.name}" for alias in node.names} if module == "course_kit" else {module}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names if alias.name.startswith("course_kit.")}
    return found


def floor_of(room: str) -> int:
    return next((number for number, rooms in enumerate(FLOORS) if room in rooms), len(FLOORS))


@pytest.mark.parametrize(
    "path", sorted((REPOSITORY / "course_kit").rglob("*.py")), ids=lambda path: str(path.relative_to(REPOSITORY))
)
def test_rooms_import_only_from_the_floors_below(path: Path) -> None:
    here = path.relative_to(REPOSITORY / "course_kit").parts[0].removesuffix(".py")
    for module in imports(path):
        there = room_of(module)
        if there == here or here in {"autoload", "__init__"}:
            continue
        assert (here, there) not in MAY_NOT_MEET, f"{here} must not import {module}"
        assert floor_of(there) < floor_of(here) or here in FLOORS[-1], f"{here} imports {module}, which is not below it"


@pytest.mark.parametrize(
    "path", sorted((REPOSITORY / "course_kit").rglob("*.py")), ids=lambda path: str(path.relative_to(REPOSITORY))
)
def test_a_module_fits_in_one_sitting(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= 300

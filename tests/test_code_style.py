"""What every file of the course kit keeps to, as far as a tool can tell."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from tests import sizes

REPOSITORY = Path(__file__).resolve().parent.parent
MOST_LINES = 450


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", *command], cwd=REPOSITORY, capture_output=True, text=True, timeout=300, check=False
    )


@pytest.mark.timeout(300)
def test_mypy_strict_is_content() -> None:
    done = run("mypy", "-p", "course_kit", "-p", "course_setup")
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("command", [("check", "."), ("format", "--check", ".")])
def test_ruff_is_content(command: tuple[str, ...]) -> None:
    done = run("ruff", *command)
    assert done.returncode == 0, done.stdout


def test_a_module_fits_in_one_sitting() -> None:
    paths = [path for package in ("course_kit", "course_setup") for path in (REPOSITORY / package).rglob("*.py")]
    lines = {str(path.relative_to(REPOSITORY)): len(path.read_text().splitlines()) for path in paths}
    assert {path: count for path, count in lines.items() if count > MOST_LINES} == {}


def test_the_set_up_needs_nothing_that_it_would_have_to_install() -> None:
    for path in (REPOSITORY / "course_setup").glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            others = {name.split(".")[0] for name in names} - sys.stdlib_module_names - {"course_setup"}
            assert others == set(), path.name


def test_no_two_public_classes_share_a_name() -> None:
    places: dict[str, list[str]] = {}
    for path in sorted((REPOSITORY / "course_kit").rglob("*.py")):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places.setdefault(node.name, []).append(str(path.relative_to(REPOSITORY)))
    assert {name: where for name, where in places.items() if len(where) > 1} == {}


def test_what_is_left_out_of_a_run_is_there() -> None:
    named = {test.partition("::")[0] for test in (*sizes.WEEKLY, *sizes.SLOW)}
    assert {path for path in named if not (REPOSITORY / path).exists()} == set()

"""What every file of the course kit keeps to, as far as a tool can tell."""

from __future__ import annotations

import ast
import functools
import subprocess
import sys
from pathlib import Path

import pytest

from tests import sizes

REPOSITORY = Path(__file__).resolve().parent.parent
MOST_LINES = 450
MOST_OF_ONE_WORD = 0.2  # of the names of the modules' public functions
NOT_ALONE = {"around", "asked", "done", "found", "given", "handed", "held", "kept", "known", "named", "of", "one"}
NOT_ALONE |= {"right", "said", "shown", "surroundings", "told", "turns", "under_way", "visiting"}


def run(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", *command], cwd=REPOSITORY, capture_output=True, text=True, check=False)


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


@functools.cache
def definitions() -> list[tuple[str, ast.stmt]]:
    """What stands at the top of each module of the kit."""
    paths = sorted((REPOSITORY / "course_kit").rglob("*.py"))
    return [(str(path.relative_to(REPOSITORY)), node) for path in paths for node in ast.parse(path.read_text()).body]


def test_no_two_public_classes_share_a_name() -> None:
    places: dict[str, list[str]] = {}
    for path, node in definitions():
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            places.setdefault(node.name, []).append(path)
    assert {name: where for name, where in places.items() if len(where) > 1} == {}


def test_no_two_modules_of_a_package_share_a_name() -> None:
    places: dict[tuple[str, str], list[Path]] = {}
    for package in (REPOSITORY / "course_kit").glob("*/__init__.py"):
        for path in package.parent.rglob("*.py"):
            if path.stem not in {"__init__", "__main__", "errors"}:
                places.setdefault((package.parent.name, path.stem), []).append(path)
    assert {name: where for name, where in places.items() if len(where) > 1} == {}


def test_functions_are_named_by_a_verb_and_its_object() -> None:
    functions = [(path, node.name) for path, node in definitions() if isinstance(node, ast.FunctionDef)]
    names = [(path, name) for path, name in functions if not name.startswith("_")]
    assert sum("_" not in name for _, name in names) <= MOST_OF_ONE_WORD * len(names)
    alone = {(path, name) for path, name in names if name in NOT_ALONE}
    classes = {(path, node.name) for path, node in definitions() if isinstance(node, ast.ClassDef)}
    assert alone | {(path, name) for path, name in classes if name.lower() in NOT_ALONE} == set()


def test_what_is_left_out_of_a_run_is_there() -> None:
    named = {test.partition("::")[0] for test in (*sizes.WEEKLY, *sizes.SLOW)}
    assert {path for path in named if not (REPOSITORY / path).exists()} == set()

"""An exercise whose checks are all declared, and a way to grade programs with some of them."""

from __future__ import annotations

import itertools
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import pytest

from course_kit import grading
from course_kit.grading import exercise
from tests.grading.conftest import worker

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from concurrent.futures import Future

    from course_kit.grading.exercise import Exercise
    from course_kit.grading.report import CheckReport, Report

__all__ = ["worker"]
HERE = Path(__file__).parent
SOLUTION = (HERE / "all_kinds.py.txt").read_text(encoding="utf-8")
ENDPOINTS = (HERE / "endpoints.toml").read_text(encoding="utf-8")
HEAD = """\
format_version = 1
id = "all_kinds"
title = "All kinds of checks"
order = 9
points = {points}
pass_mark = 0.5
class_name = "AllKinds"
starter = "all_kinds.py"
notebook = "all_kinds.ipynb"
solution = "solution/all_kinds.py"
"""
HINTS = """
[[hints]]
for = ["*"]
text = "Think."
"""


def written(folder: Path, checks: str, head: str = HEAD, more: str = HINTS) -> Path:
    """An exercise with these checks, each worth a point; returns its exercise.toml."""
    made = folder / "exercises" / "all_kinds"
    (made / "solution").mkdir(parents=True)
    (made / "solution" / "all_kinds.py").write_text(SOLUTION)
    points = float(checks.count("[[checks]]"))
    path = made / "exercise.toml"
    path.write_text(head.format(points=points) + ENDPOINTS + checks + more)
    return path


@pytest.fixture
def load(tmp_path: Path) -> Callable[..., Exercise]:
    """Loads an exercise with some checks."""

    def run(checks: str, **more: str) -> Exercise:
        path = written(tmp_path, checks, **more)
        return exercise.load("all_kinds", path.parent.parent)

    return run


@contextmanager
def grading_side_by_side(folder: Path, at_a_time: int = 6) -> Iterator[Callable[..., Future[Report]]]:
    """Begins gradings of the solution with changes, by some checks; each has an exercise of its own.

    Args:
        folder: where the exercises are made.
        at_a_time: how many run side by side: most of their time they wait.
    """
    numbers, free = itertools.count(), SimpleQueue[grading.Worker]()

    def run(checks: str, changes: tuple[tuple[str, str], ...], number: int) -> Report:
        path = written(folder / str(number), checks)
        program = folder / str(number) / "answer.py"
        program.write_text(changed(SOLUTION, changes))
        worker = free.get()
        try:
            return grading.grade("all_kinds", program, worker=worker, seed=3, exercises=path.parent.parent)
        finally:
            free.put(worker)

    with ExitStack() as opened:
        for _ in range(at_a_time):
            free.put(opened.enter_context(grading.Worker()))
        threads = opened.enter_context(ThreadPoolExecutor(at_a_time))
        opened.callback(threads.shutdown, cancel_futures=True)
        yield lambda checks, *changes: threads.submit(run, checks, changes, next(numbers))


def changed(source: str, changes: Iterable[tuple[str, str]]) -> str:
    """A program with some of its text replaced, each of which has to be there."""
    for before, after in changes:
        assert before in source, before
        source = source.replace(before, after)
    return source


@pytest.fixture
def grade(worker: grading.Worker, tmp_path: Path) -> Callable[..., Report]:
    """Grades a program by some checks; the solution with `changes` made in it, each a text and what stands instead."""

    def run(checks: str, *changes: tuple[str, str], source: str = SOLUTION, **options: Any) -> Report:
        path = written(tmp_path, checks)
        program = tmp_path / "answer.py"
        program.write_text(changed(source, changes))
        return grading.grade("all_kinds", program, worker=worker, seed=3, exercises=path.parent.parent, **options)

    return run


@pytest.fixture
def grade_one(grade: Callable[..., Report]) -> Callable[..., CheckReport]:
    """The same for a single check, whose result it returns."""

    def run(check: str, *changes: tuple[str, str], **options: Any) -> CheckReport:
        report = grade(check, *changes, **options)
        assert report.status == "graded", report.problem
        (result,) = report.checks
        return result

    return run

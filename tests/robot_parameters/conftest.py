"""All gradings of a test run side by side: most of a grading of exercise 3 is waiting for the next status line."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING

import pytest

from course_kit import environment, grading

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

EXERCISE = "robot_parameters"
ROOT = environment.checkout() or Path()
SOLUTION = ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"
WORKERS = 5


@dataclass(frozen=True)
class Mutant:
    """A right program with one thing wrong: the texts of `changes` replaced, which must occur exactly once."""

    name: str
    changes: tuple[tuple[str, str], ...]
    failed: frozenset[tuple[str, str | None]]
    says: str = ""
    base: Path = SOLUTION

    def source(self) -> str:
        text = self.base.read_text()
        for old, new in self.changes:
            assert text.count(old) == 1, (self.name, old)
            text = text.replace(old, new)
        return text


class Reports:
    """The reports of all programs that the selected tests ask for, graded by a few workers from the beginning on."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._workers: SimpleQueue[grading.Worker] = SimpleQueue()
        for _ in range(WORKERS):
            self._workers.put(grading.Worker())
        self._threads = ThreadPoolExecutor(WORKERS)
        self._reports: dict[Path | Mutant, Future[grading.Report]] = {}

    def begin(self, program: Path | Mutant) -> None:
        if program not in self._reports:
            self._reports[program] = self._threads.submit(self._grade, program)

    def of(self, program: Path | Mutant) -> grading.Report:
        self.begin(program)
        return self._reports[program].result()

    def close(self) -> None:
        self._threads.shutdown(cancel_futures=True)
        while not self._workers.empty():
            self._workers.get().close()

    def _grade(self, program: Path | Mutant) -> grading.Report:
        path = program if isinstance(program, Path) else self._folder / f"{program.name}.py"
        if isinstance(program, Mutant):
            path.write_text(program.source())
        worker = self._workers.get()
        try:
            return grading.grade(EXERCISE, path, worker=worker)
        finally:
            self._workers.put(worker)


@pytest.fixture(scope="session")
def reports(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Reports]:
    running = Reports(tmp_path_factory.mktemp("submissions"))
    for item in request.session.items:
        program = getattr(item, "callspec", None) and item.callspec.params.get("program")  # type: ignore[attr-defined]
        if program is not None and "reports" in item.fixturenames:  # type: ignore[attr-defined]
            running.begin(program)
    yield running
    running.close()


@pytest.fixture
def grade_source(tmp_path: Path, reports: Reports) -> Callable[..., grading.Report]:
    """Grades bytes or a text under a file name."""

    def run(source: str | bytes, name: str = "answer.py") -> grading.Report:
        path = tmp_path / name
        path.write_bytes(source if isinstance(source, bytes) else source.encode())
        return reports.of(path)

    return run


def not_passed(report: grading.Report) -> list[tuple[str, str, str | None, str]]:
    return [(check.id, check.status, check.diagnosis, check.message) for check in report.checks if check.points == 0]

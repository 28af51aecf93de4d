"""One warm worker for all gradings of a test run, and ways to write submissions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import psutil
import pytest
import rclpy

from course_kit import environment, grading
from course_kit.process import tree
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

EXERCISE = "temperature_service"
ROOT = environment.checkout_folder() or Path()
IDLE = 2  # processes below the warm one: the worker, and the one from which submissions are started


def processes_of(worker: grading.Worker) -> list[int]:
    """All processes of a worker, those of its submission among them."""
    return tree.descendants_of(psutil.Process(worker.process_id).ppid())


def wait_for_node(name: str, domain_id: int) -> None:
    """Return when a node is on a graph; on a busy machine its program takes longer to start than a grader waits."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain_id)
    looking = rclpy.create_node("looking", context=context)
    wait_until(lambda: name in looking.get_node_names(), name)
    looking.destroy_node()
    rclpy.shutdown(context=context)


@pytest.fixture(scope="session")
def worker() -> Iterator[grading.Worker]:
    with grading.Worker() as running:
        yield running


@pytest.fixture
def grade_source(worker: grading.Worker, tmp_path: Path) -> Callable[..., grading.Report]:
    """Grades a text as submission to exercise 1."""

    def run(source: str | bytes, name: str = "answer.py", **options: Any) -> grading.Report:
        path = tmp_path / name
        path.write_bytes(source if isinstance(source, bytes) else source.encode())
        return grading.grade(EXERCISE, path, worker=worker, **{"seed": 3, **options})

    return run


@pytest.fixture
def solution() -> str:
    return (ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py").read_text()


@pytest.fixture
def strict_exercises(tmp_path: Path) -> Callable[..., Path]:
    """A folder with exercise 1 under other limits."""

    def make(**limits: float) -> Path:
        folder = tmp_path / "exercises" / EXERCISE
        folder.mkdir(parents=True)
        text = (ROOT / "exercises" / EXERCISE / "exercise.toml").read_text()
        head, _, tail = text.partition("[limits]\n")
        kept = [line for line in tail.split("\n") if line.partition(" =")[0] not in limits]
        lines = [f"{name} = {value}" for name, value in limits.items()]
        (folder / "exercise.toml").write_text("\n".join([head + "[limits]", *lines, *kept]))
        return folder.parent

    return make

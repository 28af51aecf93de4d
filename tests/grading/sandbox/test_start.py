"""What fails before the first line of a program is the machine's fault, and no grade."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.model.submission import Submission
from course_kit.grading.workers import exercise_job
from tests.grading.conftest import EXERCISE

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit import grading

GONE = {"mode": "exec", "command": ("true",), "folder": "/gone"}
NOWHERE = "no/such/folder.py"
FULL = {"mode": "run", "text": Submission(NOWHERE, NOWHERE, "print('begins')")}  # as on a disk that is full


@pytest.mark.parametrize("odd", [GONE, FULL])
def test_a_program_that_cannot_be_started_is_no_grade(worker: grading.Worker, odd: dict[str, Any]) -> None:
    job = replace(exercise_job.make_job_of_node(load_exercise(EXERCISE), 3), **odd)
    worker.send(job)
    outcome = worker.receive(job)
    assert (outcome["results"], outcome["stdout"]) == ([], "")
    assert "the program could not be started: [Errno 2] No such file or directory" in outcome["problem"]


IDLE = """
import time
from rclpy.node import Node

class TemperatureService(Node):
    def __init__(self):
        super().__init__("temperature_server")
        self.began = time.monotonic(), time.process_time()
        self.ticks = 0
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.ticks += 1
        if self.ticks == 12:
            wall, computed = time.monotonic() - self.began[0], time.process_time() - self.began[1]
            print(f"SHARE {computed / wall:.3f}", flush=True)
"""


def test_a_class_that_the_grader_starts_computes_nothing_while_it_waits(
    grade_source: Callable[..., grading.Report],
) -> None:
    """An executor that follows what follows its callbacks turns without end, and takes the program's time."""
    share = float(re.search(r"SHARE (\S+)", grade_source(IDLE).stdout)[1])  # type: ignore[index]
    assert share < 0.5

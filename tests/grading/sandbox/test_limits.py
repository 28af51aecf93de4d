"""Each limit at its edge: below it a submission is graded, above it the report says which was hit."""

from __future__ import annotations

import re
import resource
from typing import TYPE_CHECKING

import pytest

from course_kit.grading.model.job import Job
from course_kit.grading.model.limits import Limits
from course_kit.grading.model.plain_data import convert_record
from course_kit.grading.sandbox import machine
from tests.grading.sandbox import attack_modes

if TYPE_CHECKING:
    from course_kit import grading

Grade = "Callable[..., grading.Report]"
Strict = "Callable[..., Path]"


def first_diagnosis(report: grading.Report) -> str | None:
    return next((check.diagnosis for check in report.checks if check.status == "failed"), None)


def before(solution: str, code: str) -> str:
    """The solution with `code` run before its node is made."""
    return solution.replace("    rclpy.init()\n", f"    {code}\n    rclpy.init()\n")


BELOW = """import threading, time; global kept
    kept = [bytearray(b'x' * 100_000_000), *(open('/dev/null') for _ in range(60))]
    [threading.Thread(target=time.sleep, args=(60,), daemon=True).start() for _ in range(10)]
    open('data', 'wb').write(b'x' * 900_000)
    print('a' * 1024 * 60)"""


def test_a_program_below_each_limit_is_graded(grade_source: Grade, strict_exercises: Strict, solution: str) -> None:
    """What is above them is in the corpus: `limit.memory`, `limit.processes` and `limit.output`."""
    folder = strict_exercises(memory_mb=300, tasks=64, output_kb=100, file_mb=1, open_files=128)
    report = grade_source(before(solution, BELOW), exercises=folder)
    assert report.score == 10.0
    assert len(report.stdout) < 9000
    assert "bytes left out" in report.stdout


def test_sockets_of_an_ordinary_program_are_far_from_the_limit_on_memory(
    grade_source: Grade, worker: grading.Worker, solution: str
) -> None:
    """It and the grader share a network; each participant of the graph has about a dozen."""
    code = "import threading; threading.Timer(0.1, lambda: print(open('/proc/net/sockstat').readline())).start()"
    report = grade_source(before(solution, code))
    assert report.score == 10.0
    if worker.ready().network:
        sockets = int(report.stdout.split()[2])
        assert sockets > 2
        assert sockets * 2 * machine.BUFFER < Limits().memory_mb * 1024 * 1024 / 10


@pytest.mark.parametrize(
    ("limits", "code", "said"),
    [
        ({"file_mb": 1}, "open('data', 'wb').write(b'x' * 1_100_000)", "File too large"),
        ({"open_files": 128}, "kept = [open('/dev/null') for _ in range(140)]", "Too many open files"),
    ],
)
def test_files_above_a_limit_are_an_error_of_the_system(  # noqa: PLR0913, PLR0917 - three fixtures
    limits: dict[str, float], code: str, said: str, grade_source: Grade, strict_exercises: Strict, solution: str
) -> None:
    report = grade_source(before(solution, code), exercises=strict_exercises(**limits))
    assert first_diagnosis(report) == "start.crash"
    assert said in report.stderr


def test_computing_time(grade_source: Grade, strict_exercises: Strict) -> None:
    folder = strict_exercises(cpu_s=1, start_s=30.0)
    report = grade_source("while True:\n    pass\n", exercises=folder)
    assert first_diagnosis(report) == "limit.time"
    assert report.duration_s < 30


def test_wall_time(grade_source: Grade, strict_exercises: Strict) -> None:
    folder = strict_exercises(wall_s=2.0, start_s=50.0)
    report = grade_source("import time\nwhile True:\n    time.sleep(1)\n", exercises=folder)
    assert first_diagnosis(report) == "limit.time"
    assert report.duration_s < 40


def test_a_program_that_computes_without_a_node_is_given_up_by_what_it_has_computed(
    grade_source: Grade, strict_exercises: Strict
) -> None:
    folder = strict_exercises(start_s=50.0, start_cpu_s=1.0)
    report = grade_source("count = 0\nwhile True:\n    count += 1\n", exercises=folder)
    assert first_diagnosis(report) == "limit.time"
    assert re.search(r"has computed for 1 s and .* Your program stays in line [23]", report.checks[0].message)


def test_a_start_that_computes_within_the_limit(grade_source: Grade, strict_exercises: Strict, solution: str) -> None:
    folder = strict_exercises(start_s=50.0, start_cpu_s=3.0)
    code = "import time; any(time.process_time() > 1.5 for _ in iter(int, 1))"
    assert grade_source(before(solution, code), exercises=folder).score == 10.0


def test_a_command_is_not_held_to_what_a_loaded_program_may_compute() -> None:
    limits = Limits(start_cpu_s=1.0)
    assert [Job("temperature_service", mode, 1, limits=limits).start_cpu_s for mode in ("run", "exec")] == [
        1.0,
        float("inf"),
    ]


def test_infinite_loop_in_a_callback_names_its_line(grade_source: Grade, solution: str) -> None:
    source = solution.replace(
        "    if not math.isfinite(request.value):\n",
        "    while request.value != request.value:\n        pass\n    if not math.isfinite(request.value):\n",
    )
    report = grade_source(source)
    failed = [check for check in report.checks if check.status == "failed"]
    assert [(check.id, check.diagnosis) for check in failed] == [("not_a_number", "limit.time")]
    assert report.score == 9.0


@pytest.mark.parametrize("values", [{"memory": 5}, {"tasks": 0}, {"cpu_s": "10"}, {"wall_s": True}])
def test_a_mistake_in_the_limits_is_named(values: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=next(iter(values))):
        convert_record(values, Limits)


def test_what_the_user_starts_meanwhile_takes_nothing_from_a_submission_without_namespaces() -> None:
    """There the kernel counts all of a user's tasks together; those of other gradings come and go."""
    asks = "import resource; print('LIMIT', *resource.getrlimit(resource.RLIMIT_NPROC))\n"
    outcome = attack_modes.outcomes(attack_modes.USER_ALONE, {"asks": asks})["asks"]
    soft = int(outcome["stdout"].split()[1])
    _, hard = resource.getrlimit(resource.RLIMIT_NPROC)
    assert soft >= 4096 or soft == hard, outcome

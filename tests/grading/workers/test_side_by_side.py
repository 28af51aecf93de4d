"""Workers that are started together: they share getting warm, and nothing after it."""

from __future__ import annotations

import os
import signal
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

import psutil
import pytest

from course_kit import grading
from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.workers.worker import start_workers
from tests.grading.conftest import EXERCISE, ROOT
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.grading import Worker

SOLUTION = ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"

pytestmark = pytest.mark.answers


@pytest.fixture
def pair() -> Iterator[list[Worker]]:
    workers = start_workers(2, [load_exercise("robot_parameters")])
    yield workers
    for worker in workers:
        worker.close()


def warm_process(worker: Worker) -> psutil.Process:
    parent = psutil.Process(worker.process_id).parent()
    assert parent is not None
    return parent


def test_each_grades_while_the_other_one_does(pair: list[Worker]) -> None:
    with ThreadPoolExecutor(2) as threads:
        reports = list(threads.map(lambda worker: grading.grade(EXERCISE, SOLUTION, worker=worker), pair))
    assert [report.score for report in reports] == [10.0, 10.0]
    assert pair[0].process_id != pair[1].process_id
    assert warm_process(pair[0]) == warm_process(pair[1])
    forks = [fork.pid for fork in warm_process(pair[0]).children()]  # each worker, and what starts its programs
    assert [os.getsid(fork) for fork in forks] == forks
    assert len(forks) == 4


def test_one_that_is_killed_is_told_and_costs_the_other_nothing(pair: list[Worker], tmp_path: Path) -> None:
    victim, other = pair
    (tmp_path / "a.py").write_text("import time\ntime.sleep(600)\n")
    victim.ready()

    def kill() -> None:
        wait_until(lambda: len(psutil.Process(victim.process_id).children(recursive=True)) >= 1)  # grader
        os.kill(victim.process_id, signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    with pytest.raises(grading.GradingError, match="ended while it was grading"):
        grading.grade(EXERCISE, tmp_path / "a.py", worker=victim)
    killer.join()
    assert grading.grade(EXERCISE, SOLUTION, worker=other).score == 10.0


def test_closing_them_leaves_no_process_and_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    pair = start_workers(2)
    processes = [warm_process(pair[0]), *(psutil.Process(worker.process_id) for worker in pair)]
    assert len(list(tmp_path.iterdir())) == 2
    for worker in pair:
        worker.close()
        worker.close()  # as a class run does that gives up while a worker is discarded
    assert not any(one.is_running() for one in processes)
    assert not any(tmp_path.iterdir())


def test_a_program_finds_the_interfaces_of_its_exercise_loaded(pair: list[Worker]) -> None:
    """Those that all workers have loaded together, and those of an exercise that one meets with the first job."""
    names = ("geometry_msgs", "course_interfaces.srv", "course_interfaces.action")
    looks = f"import sys\nprint(*(one for one in {names} if one in sys.modules))\n"
    found = []
    for exercise in (EXERCISE, "move_robot"):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "looks.py"
            path.write_text(looks, encoding="utf-8")
            found.append(grading.grade(exercise, path, worker=pair[0]).stdout.splitlines()[0])
    assert found == [" ".join(names[:2]), " ".join(names)]


def test_functions_are_bound_before_all_forks_and_not_in_what_a_submission_starts(
    pair: list[Worker], tmp_path: Path
) -> None:
    program = tmp_path / "a.py"
    program.write_text("import subprocess\nprint(subprocess.run(['env'], capture_output=True, text=True).stdout)\n")
    said = grading.grade(EXERCISE, program, worker=pair[0]).stdout
    assert warm_process(pair[0]).environ()["LD_BIND_NOW"] == "1"
    assert "PATH=" in said
    assert "LD_BIND_NOW" not in said

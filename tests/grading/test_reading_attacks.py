"""Files that attack whoever reads them: each costs its own grade, and neither the grader nor anybody else's."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

import psutil
import pytest

from course_kit import environment, grading
from tests.grading.conftest import EXERCISE
from tests.grading.hard_to_read import FILES, full
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

PATIENCE_S = 200.0  # against hanging only
pytestmark = [pytest.mark.answers, pytest.mark.timeout(300)]


@pytest.mark.parametrize("what", FILES)
def test_a_file_that_is_hard_to_read_gets_its_report(
    what: str, grade_source: Callable[..., grading.Report], solution: str, tmp_path: Path
) -> None:
    hard = FILES[what]
    report = grade_source(hard.data(solution), hard.name)
    (tmp_path / hard.name).unlink()  # of those tests that pytest keeps nobody wants 64 MB
    told = report.problem or str(report.checks[0].diagnosis)
    assert report.status in hard.status, told
    assert report.score == hard.score
    assert hard.said in told
    assert len(report.to_json()) < 100_000
    assert all(len(line) < 2000 for line in grading.render_text(report).splitlines())


@contextmanager
def class_run(folder: Path) -> Iterator[subprocess.Popen[str]]:
    command = ["class", folder, "--exercise", EXERCISE, "--out", folder.parent / "out", "--layout", "folders"]
    process = subprocess.Popen(
        [sys.executable, "-m", "course_kit", *map(str, command)],
        env=environment.child_environment(PYTHONUNBUFFERED="1"),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    try:
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


def hand_in(folder: Path, student: str, name: str, data: bytes) -> None:
    (folder / student).mkdir(parents=True)
    (folder / student / name).write_bytes(data)


def test_the_rest_of_a_class_is_graded(tmp_path: Path, solution: str) -> None:
    """All of them at once, each a student's, beside one that is right."""
    students = {f"s{place:02}": hard for place, hard in enumerate(FILES.values())}
    for student, hard in students.items():
        hand_in(tmp_path / "in", student, hard.name, hard.data(solution))
    hand_in(tmp_path / "in", "zoe", f"{EXERCISE}.py", solution.encode())
    with class_run(tmp_path / "in") as process:
        said, _ = process.communicate(timeout=PATIENCE_S)
    for path in (tmp_path / "in").glob("*/*.ipynb"):
        path.unlink()
    assert process.returncode == 0, said
    assert "Traceback" not in said
    records = {path.parent.name: path for path in (tmp_path / "out/students").glob("*/*.json")}
    reports = {name: json.loads(path.read_text())["report"] for name, path in records.items()}
    assert set(reports) == {*students, "zoe"}
    for student, hard in students.items():
        assert reports[student]["status"] in hard.status, (hard.name, reports[student])
        assert reports[student]["score"] == hard.score
    assert (reports["zoe"]["status"], reports["zoe"]["score"]) == ("graded", 10.0)
    assert all(path.stat().st_size < 200_000 for path in (tmp_path / "out").rglob("*.*"))


def test_ctrl_c_ends_a_class_while_it_is_read(tmp_path: Path) -> None:
    """Reading one of these takes seconds, all of them minutes."""
    for number in range(60):
        text = f"a = {number}\nb = f'" + "{a}" * 349_000 + "'\n"
        hand_in(tmp_path / "in", f"s{number}", f"{EXERCISE}.py", text.encode())
    with class_run(tmp_path / "in") as process:
        wait_until(lambda: is_reading(process.pid), "the first submission being read")
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        said, _ = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130, said
    assert "Traceback" not in said
    assert "Nothing was graded; run the same command again." in said
    assert list((tmp_path / "out/students").glob("*/*.json")) == []


def is_reading(process: int) -> bool:
    """Whether the reader of a class run is at work on a submission: it has a child."""
    try:
        readers = [one for one in psutil.Process(process).children() if "course_kit.reader" in " ".join(one.cmdline())]
        return any(one.children() for one in readers)
    except psutil.NoSuchProcess:
        return False


def test_a_notebook_is_found_by_a_cell_behind_large_outputs(tmp_path: Path, solution: str) -> None:
    """Its name tells nothing, and there is another program beside it."""
    outputs = {"cell_type": "code", "source": "1", "outputs": ["a" * 5_000_000]}
    cell = {"cell_type": "code", "source": f"%%submission {EXERCISE}\n{solution}"}
    hand_in(tmp_path / "in", "ann", "work.ipynb", json.dumps({"cells": [outputs, cell]}).encode())
    (tmp_path / "in/ann/notes.py").write_text(full("\n"))
    with class_run(tmp_path / "in") as process:
        said, _ = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0, said
    record = json.loads((tmp_path / f"out/students/ann/{EXERCISE}.json").read_text())
    assert (record["entry"]["source"], record["report"]["score"]) == ("ann/work.ipynb", 10.0)

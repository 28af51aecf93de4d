"""Whatever process of a class run is killed: no result is lost, none is wrong, and the run can be completed.

The class command itself is killed in `test_interrupted_runs`. Thirty kills of each role in a class of sixty:

    COURSE_KILLS=30 COURSE_KILLS_SIZE=60 .venv/bin/python -m pytest tests/classroom/test_killed_roles.py
    COURSE_RUN_KILLS=30 .venv/bin/python -m pytest tests/classroom/test_interrupted_runs.py
"""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import psutil
import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).resolve().parent.parent.parent
EXERCISE = "temperature_service"
pytestmark = [pytest.mark.answers]
ROLES = (
    "grade warm",
    "grade launcher",
    "grade worker",
    "grade grader",
    "grade enter",
    "grade init",
    "submission",
    "reader",
    "reader's child",
)
READING = b"course_kit.reader.process"
SIZE = int(os.environ.get("COURSE_KILLS_SIZE", "8"))
KILLS = int(os.environ.get("COURSE_KILLS", "3"))  # of each role
PATIENCE_S = 100.0 + 10.0 * SIZE  # against hanging only
WRONG = "validation.missing"
NOTES = 40  # further programs of each student, so that the class is read for a while


@pytest.fixture(scope="module")
def inbox(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A class in which every other submission is wrong, each in its own text, so that each is graded."""
    folder = tmp_path_factory.mktemp("inbox")
    right = (ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py").read_text()
    wrong = (ROOT / "tests" / "broken" / EXERCISE / f"{WRONG}.py").read_text()
    for number in range(SIZE):
        text = (right, wrong)[number % 2]
        (folder / f"student{number:03}").mkdir()
        (folder / f"student{number:03}" / f"{EXERCISE}.py").write_text(f"{text}\n# {number}\n")
    return folder


def with_notes(inbox: Path) -> None:
    """Let everybody hand in more programs, which are nobody's submission."""
    for student in inbox.iterdir():
        for number in range(NOTES):
            (student / f"note_{number}.py").write_text(f"note = {number}\n")


@pytest.fixture(scope="module")
def scores(inbox: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, float]:
    """What a run in peace gives."""
    out = tmp_path_factory.mktemp("peace") / "out"
    assert class_run(inbox, out).wait(PATIENCE_S) == 0
    return {student: score for student, (_, score) in results(out).items()}


def class_run(inbox: Path, out: Path, *more: str) -> subprocess.Popen[bytes]:
    words = ["class", str(inbox), "--exercise", EXERCISE, "--out", str(out), "--seed", "3", "--workers", "2", *more]
    program = "import sys; from course_kit.__main__ import main; sys.exit(main())"
    return subprocess.Popen(
        [sys.executable, "-c", program, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


def results(out: Path) -> dict[str, tuple[str, float]]:
    """Status and score by student."""
    records = [json.loads(path.read_text()) for path in out.glob("students/*/*.json")]
    return {one["entry"]["student"]: (one["report"]["status"], one["report"]["score"]) for one in records}


def of_role(run: subprocess.Popen[bytes], role: str) -> Iterator[psutil.Process]:
    for process in psutil.Process(run.pid).children(recursive=True):
        with suppress(OSError):  # it has ended meanwhile
            if Path(f"/proc/{process.pid}/comm").read_text().strip() == role[:15]:
                yield process


def readers(run: subprocess.Popen[bytes], role: str) -> Iterator[psutil.Process]:
    """The process that reads submissions, or its child that reads one: it lives for a few milliseconds."""
    for reader in _children(run.pid):
        if READING in _command(reader):
            yield from map(psutil.Process, [reader] if role == "reader" else _children(reader))


def _children(process: int) -> list[int]:
    found: list[int] = []
    with suppress(OSError):  # it has ended meanwhile
        for path in Path(f"/proc/{process}/task").glob("*/children"):
            found += map(int, path.read_text().split())
    return found


def _command(process: int) -> bytes:
    with suppress(OSError):
        return Path(f"/proc/{process}/cmdline").read_bytes()
    return b""


def wait_for_others(run: subprocess.Popen[bytes], out: Path) -> None:
    """Wait until more results have come than there are workers, so that it is somebody else's turn."""
    before, pause = len(results(out)), threading.Event()
    while len(results(out)) <= before + 2 and run.poll() is None:
        pause.wait(0.05)


def kill_some(run: subprocess.Popen[bytes], role: str, out: Path, chance: random.Random) -> int:
    """Kill processes of a role at moments nobody has chosen; returns how many it were."""
    killed, pause = 0, threading.Event()
    find, longest_s = (readers, 0.15) if role.startswith("reader") else (of_role, 0.25)
    while killed < KILLS and run.poll() is None:
        pause.wait(chance.random() * longest_s)  # no synchronisation: any moment will do
        try:
            if found := list(find(run, role)):
                chance.choice(found).send_signal(signal.SIGKILL)
                killed += 1
                if role == "submission":  # one that is killed again and again is taken to do it itself
                    wait_for_others(run, out)
        except psutil.NoSuchProcess:
            continue
    return killed


@pytest.mark.timeout(4 * PATIENCE_S)
@pytest.mark.parametrize("role", ROLES)
def test_killing_costs_nothing_and_makes_nothing_wrong(
    role: str, inbox: Path, scores: dict[str, float], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    if role.startswith("reader"):
        with_notes(inbox)
    run = class_run(inbox, out)
    killed = kill_some(run, role, out, random.Random(role))  # noqa: S311 - moments, not secrets
    code = run.wait(PATIENCE_S)
    assert killed
    found = results(out)
    assert set(found) == set(scores), "somebody was lost"
    graded = {student: score for student, (status, score) in found.items() if status != "error"}
    assert graded == {student: scores[student] for student in graded}, "a grade is wrong"
    assert code == (0 if len(graded) == len(scores) else 2)
    if len(graded) < len(scores):
        assert class_run(inbox, out, "--resume").wait(PATIENCE_S) == 0
    assert {student: score for student, (_, score) in results(out).items()} == scores

"""The process that reads submissions: it is apart, it is small, and it ends with whoever has started it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import psutil
import pytest

from course_kit.grading.errors import GradingError
from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.model.submission import UnreadableError
from course_kit.grading.reading import Copy, Reader, ReadingStoppedError, copy_file
from course_kit.reader import process
from course_kit.reader.python import MEMORY_MB
from tests.reading import read
from tests.waiting import wait_until

if TYPE_CHECKING:
    from pathlib import Path

EXERCISE, CHOICE = load_exercise("temperature_service"), load_exercise("pattern_choice")
SOLUTION = EXERCISE.solution.read_text(encoding="utf-8")
SLOW = "a = 1\nb = f'" + "{a}" * 349_000 + "'\n"  # takes seconds, whatever the Python
# A module that lies where the reader was started from, or where the user's own variables lead, is not loaded.
PLANTED = "open({trace!r}, 'w').close()\nraise SystemExit('planted')\n"


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "answer.py"
    path.write_text("async def f(node, client):\n    x = 7 // 2\n    await client.call_async(x)\n")
    return path


def test_nothing_beside_a_submission_is_loaded(program: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trace = tmp_path / "trace"
    for name in ("json", "ast", "re", "socket", "signal", "numpy", "sitecustomize", "usercustomize", "keyword"):
        (tmp_path / f"{name}.py").write_text(PLANTED.format(trace=str(trace)))
    (tmp_path / "course_kit").mkdir()
    (tmp_path / "course_kit/__init__.py").write_text(PLANTED.format(trace=str(trace)))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("PYTHONSTARTUP", str(tmp_path / "json.py"))
    found = read(program, EXERCISE.id)
    assert found.fault is None
    assert not trace.exists()


def test_what_the_text_gives_away(program: Path) -> None:
    facts = read(program, EXERCISE.id).facts
    assert (facts.awaits, facts.floor_divides, facts.loops, facts.functions) == (True, True, False, ())
    outer = "def outer(self):\n    f = self.call_async(1)\n"
    program.write_text(f"{outer}    def inner():\n        pass\n    while f.done():\n        pass\n")
    facts = read(program, EXERCISE.id).facts
    assert (facts.awaits, facts.floor_divides, facts.loops) == (False, False, True)
    assert [facts.waits_for_a_future(line) for line in (1, 2, 4, 5, 7)] == [True, True, False, True, False]


@pytest.mark.parametrize(
    ("text", "waits"),
    [
        ("import time\ntime.sleep(9)\n", True),
        ("from time import sleep\nsleep(9)\n", True),
        ("response = self.client.call(request)\n", True),
        ("await Future()\n", True),
        ("self.event.wait()\n", True),
        ("while True:\n    pass\n", False),
        ("for sleep in (1, 2):\n    print(sleep)\n", False),
        ("makers[0]()()\n", False),
    ],
)
def test_calls_that_may_wait_for_long_are_seen(text: str, waits: bool, program: Path) -> None:
    program.write_text(text)
    assert read(program, EXERCISE.id).facts.waits is waits


def test_a_reader_that_somebody_has_killed_gets_a_successor(program: Path) -> None:
    with Reader() as reader, copy_file(program) as copy:
        first = reader.read(copy, EXERCISE)
        killed = reader._process.pid
        os.kill(killed, signal.SIGKILL)
        assert reader.read(copy, EXERCISE) == first
        assert reader._process.pid != killed


def test_a_child_of_the_reader_that_somebody_has_killed_is_no_fault_of_the_submission(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "slow.py").write_text(SLOW)
    killed: list[int] = []

    def kill(*line: Any, receive: Any = process.receive_packet) -> Any:
        of_reader = psutil.Process(reader._process.pid)
        wait_until(of_reader.children, "the reader being at work")
        for child in of_reader.children():
            killed.append(child.pid)
            child.kill()
        return receive(*line)

    monkeypatch.setattr(process, "receive_packet", kill)
    with Reader() as reader, copy_file(tmp_path / "slow.py") as copy, pytest.raises(GradingError, match="was reading"):
        reader.read(copy, EXERCISE)
    assert len(killed) == 2


def test_it_stops_when_somebody_asks_for_it(program: Path) -> None:
    stopped: list[bool] = []
    with Reader(lambda: bool(stopped)) as reader, copy_file(program) as copy:
        assert reader.read(copy, EXERCISE)
        stopped.append(True)
        with pytest.raises(ReadingStoppedError):
            reader.read(copy, EXERCISE)


STARTS_ONE = """
import sys
from pathlib import Path
from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.reading import Reader, copy_file

reader = Reader()
reader.start()
print(reader._process.pid, flush=True)
with copy_file(Path(sys.argv[1])) as copy:
    reader.read(copy, load_exercise("temperature_service"))
sys.stdin.read()
"""


@pytest.mark.parametrize("text", ["x = 1\n", SLOW])
def test_it_ends_with_whoever_has_started_it_at_rest_and_at_work(text: str, tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text(text)
    command = [sys.executable, "-c", STARTS_ONE, str(tmp_path / "a.py")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as user:
        assert user.stdout is not None
        reader = psutil.Process(int(user.stdout.readline()))
        if text == SLOW:
            wait_until(reader.children, "the reader being at work")
        below = [reader, *reader.children()]
        user.kill()
    psutil.wait_procs(below, timeout=200)
    assert not any(one.is_running() for one in below)


def test_limits_hold_and_are_told(tmp_path: Path) -> None:
    path = tmp_path / "a.py"
    path.write_text("a;" * 500_000)
    with pytest.raises(UnreadableError, match=rf"^a.py cannot be read: .* {MEMORY_MB} MB of memory .*\.$"):
        read(path, EXERCISE.id)
    notebook = tmp_path / "a.ipynb"
    notebook.write_text(f'{{"cells": [], "x": [{"[]," * 20_000_000}0]}}')
    with pytest.raises(UnreadableError, match=r"^a.ipynb cannot be read: .* Clear its outputs and hand in a shorter"):
        read(notebook, EXERCISE.id)


def test_who_computes_too_long_is_ended() -> None:
    endless = "from course_kit.reader import process\nprocess.CPU_S = 1\nprocess.apply_limits()\nwhile True: pass"
    done = subprocess.run([sys.executable, "-c", endless], timeout=200, check=False)
    assert done.returncode == -signal.SIGXCPU


NO_FILES = """
import resource, sys
from pathlib import Path
from course_kit.grading.errors import GradingError
from course_kit.grading.reading import copy_file

held = []
try:
    while True:
        held.append(open("/dev/null"))
except OSError:
    held.pop()
    if sys.argv[2] == "none":
        held.append(open("/dev/null"))
try:
    sys.stdout.write(f"{copy_file(Path(sys.argv[1])).size} bytes")
except GradingError as problem:
    sys.stdout.write(str(problem))
"""


@pytest.mark.parametrize(("left", "said"), [("none", "Too many open files"), ("one", "bytes")])
def test_a_machine_that_has_no_more_files_is_no_fault_of_the_submission(left: str, said: str, program: Path) -> None:
    command = [
        sys.executable,
        "-c",
        f"import resource; resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64))\n{NO_FILES}",
    ]
    done = subprocess.run([*command, program, left], capture_output=True, text=True, timeout=200, check=True)
    assert said in done.stdout


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What a reader's children were asked for, as it grows."""
    told: list[str] = []
    exchange = Reader._exchange

    def record(self: Reader, request: dict[str, object], copy: Copy) -> tuple[dict[str, object], bytes]:
        told.append(f"{copy.name} for {request['exercise']}")
        return exchange(self, request, copy)

    monkeypatch.setattr(Reader, "_exchange", record)
    return told


@pytest.mark.parametrize("text", [SOLUTION, f"{SOLUTION}\ndef (\n"], ids=["right", "no Python"])
def test_a_submission_is_read_while_it_is_looked_at(text: str, program: Path, asked: list[str]) -> None:
    program.write_text(text)
    with Reader() as reader, copy_file(program) as copy:
        due = reader.read(copy, EXERCISE)
    with Reader() as known, copy_file(program) as copy:
        summary = known.summarize(copy, EXERCISE)
        assert summary.found
        assert summary.prints
        assert known.read(copy, EXERCISE) == due
    with Reader(lambda: True, memory=known.memory) as again, copy_file(program) as copy:
        assert again.read(copy, EXERCISE) == due
        assert again.summarize(copy, EXERCISE) == summary
        with pytest.raises(ReadingStoppedError):
            again.read(copy, CHOICE)
    assert asked == 2 * [f"{program.name} for {EXERCISE.id}"]


def test_another_name_text_or_exercise_is_another_reading(program: Path, tmp_path: Path, asked: list[str]) -> None:
    second = tmp_path / "second.py"
    for path in (program, second):
        path.write_text(SOLUTION)
    with Reader() as known:
        with copy_file(program) as copy:
            known.summarize(copy, EXERCISE)
            assert known.read(copy, CHOICE).name == program.name
        program.write_text("answers = {}\n")
        with copy_file(second) as copy, copy_file(program) as after:
            assert known.read(copy, EXERCISE).name == "second.py"
            assert known.read(after, EXERCISE).source == "answers = {}\n"
            assert not known.summarize(after, EXERCISE).found
    one, other = (f"{program.name} for {exercise.id}" for exercise in (EXERCISE, CHOICE))
    assert asked == [one, other, f"second.py for {EXERCISE.id}", one, one]

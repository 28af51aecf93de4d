"""`course-kit watch`: one verdict after each save, whatever way the editor saves, until Ctrl-C."""

from __future__ import annotations

import os
import queue
import signal
import subprocess
import threading
import time
from typing import TYPE_CHECKING

import psutil
import pytest

from course_kit.grading import CheckReport, Report
from course_kit.learner import watch
from tests.background import IN_BACKGROUND
from tests.course_copy import SOLUTION, TEMPERATURE, Course, starter

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

DEADLINE = 60.0  # seconds; only against hanging
REFUSES_ALL = "raise SystemExit(3)\n"


class Watching:
    """A running `course-kit watch`, and the lines it prints."""

    def __init__(self, course: Course, file: Path, started: Sequence[str] = ()) -> None:
        self.process = subprocess.Popen(
            [*started, *course.command("watch", TEMPERATURE, str(file))], cwd=course.root, env=course.environ(),
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True,
        )  # fmt: skip
        self.lines: list[str] = []
        self._arriving: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._reader = threading.Thread(target=self._read)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._arriving.put(line.rstrip("\n"))
        self._arriving.put(None)

    def until(self, text: str) -> str:
        """The next line with `text` in it."""
        while (line := self._arriving.get(timeout=DEADLINE)) is not None:
            self.lines.append(line)
            if text in line:
                return line
        raise AssertionError(f"It ended without a line with {text!r}: {self.lines}")

    def interrupt(self) -> str:
        """Ctrl-C; returns what is printed from then on."""
        self.process.send_signal(signal.SIGINT)
        assert self.process.wait(DEADLINE) == 0
        self._reader.join(DEADLINE)
        rest = list(iter(self._arriving.get_nowait, None))
        return "\n".join(line for line in rest if line is not None)

    def close(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self._reader.join()
        assert self.process.stdout is not None
        self.process.stdout.close()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return starter(tmp_path, "mine.py")


@pytest.fixture
def watching(tmp_path: Path, file: Path) -> Iterator[Watching]:
    running = Watching(Course(tmp_path), file)
    yield running
    running.close()


def workers_of(process: subprocess.Popen[str]) -> list[psutil.Process]:
    return psutil.Process(process.pid).children(recursive=True)


def save_by_renaming(file: Path, text: str) -> None:
    fresh = file.with_name(f"{file.name}.part")
    fresh.write_text(text)
    fresh.replace(file)


def test_ctrl_c_ends_it_wherever_it_was_started(tmp_path: Path, file: Path) -> None:
    watching = Watching(Course(tmp_path), file, IN_BACKGROUND)
    try:
        watching.until("points")
        assert "No longer watching." in watching.interrupt()
    finally:
        watching.close()


@pytest.mark.answers
def test_each_save_gets_one_verdict_and_ctrl_c_ends_it(watching: Watching, file: Path) -> None:
    assert "1 of 10 points, not passed yet" in watching.until("points")
    assert ("You are grading as root." in " ".join(watching.lines)) == (os.geteuid() == 0)
    save_by_renaming(file, SOLUTION.read_text())
    assert "10 of 10 points, passed" in watching.until("points")
    assert "+9 since the last save" in watching.lines[-1]
    file.write_text(REFUSES_ALL)  # in place
    assert "0 of 10 points" in watching.until("points")
    file.unlink()
    watching.until("is gone. Waiting for it to come back.")
    file.write_text(SOLUTION.read_text())
    assert "10 of 10 points, passed" in watching.until("points")
    workers = workers_of(watching.process)
    assert workers
    rest = watching.interrupt()
    assert "No longer watching. Best: 10 of 10 points, passed." in rest
    assert "points: " not in rest
    assert "Traceback" not in rest
    assert psutil.wait_procs(workers, DEADLINE)[1] == []
    assert max(map(len, watching.lines)) <= 80 + len(str(file.parent))
    assert '"tries": 4' in (file.parent / "progress.json").read_text()


def test_what_it_cannot_watch_is_said_at_once(tmp_path: Path) -> None:
    done = Course(tmp_path).run("watch", TEMPERATURE, str(tmp_path / "none.py"))
    assert done.returncode == 2
    assert "none.py" in done.stderr


class Saves:
    """`watch.wait_for_saves` on a thread, with each verdict taking as long as the test wants."""

    def __init__(self, path: Path) -> None:
        self.stop = threading.Event()
        self.began: queue.SimpleQueue[str] = queue.SimpleQueue()
        self.go_on: queue.SimpleQueue[None] = queue.SimpleQueue()
        self._path = path
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self) -> None:
        for _ in watch.wait_for_saves(self._path, self.stop, poll_s=0.01):
            self.began.put(self._path.read_text())
            self.go_on.get(timeout=DEADLINE)

    def close(self) -> None:
        self.stop.set()
        self.go_on.put(None)
        self._thread.join(DEADLINE)


@pytest.fixture
def saves(tmp_path: Path) -> Iterator[Saves]:
    (tmp_path / "file.py").write_text("1")
    running = Saves(tmp_path / "file.py")
    yield running
    running.close()


def test_a_save_during_a_grading_is_not_missed_and_several_are_one(saves: Saves, tmp_path: Path) -> None:
    assert saves.began.get(timeout=DEADLINE) == "1"
    for text in ("2", "3", "4"):
        (tmp_path / "file.py").write_text(text)
    saves.go_on.put(None)
    assert saves.began.get(timeout=DEADLINE) == "4"
    saves.go_on.put(None)
    with pytest.raises(queue.Empty):
        saves.began.get(timeout=0.3)


def report(score: float, *checks: CheckReport, status: str = "graded", problem: str = "") -> Report:
    return Report("id", "Title", "f.py", status, score >= 7, score, 10.0, 1.25, checks, problem=problem)


def check(title: str, status: str, **more: str) -> CheckReport:
    return CheckReport(title, title, status, 1.0, **more)


def test_the_card_explains_the_first_failure_and_names_the_others() -> None:
    long = "word " * 40
    checks = (
        check("One", "passed"),
        check("Two", "failed", sent="1", expected="2", got="3", message=long, hint="Look."),
        check("Three", "failed", message="not shown"),
        check("Four", "skipped"),
    )
    lines = watch.verdict_card(report(3.5, *checks), report(5.0)).splitlines()
    assert lines[1].endswith("3.5 of 10 points, not passed yet (1.2 s), -1.5 since the last save")
    assert time.strptime(lines[1][:8], "%H:%M:%S")
    text = "\n".join(lines)
    for part in ("FAIL  Two", "sent      1", "expected  2", "got       3", "hint      Look.", "FAIL  Three", "skip  1"):
        assert part in text
    assert "PASS  1 of 4 checks" in text
    assert "not shown" not in text
    assert max(map(len, lines)) <= 80
    assert text.isascii()


def test_the_card_is_not_steered_by_what_the_program_has_printed() -> None:
    failed = check("One\x1b[2J", "failed", got="\x1b]0;mine\x07", message="\x1b[31mred")
    text = watch.verdict_card(report(3.5, failed, problem="\x1b[1mbold"), None)
    assert "\x1b" not in text
    assert "\x07" not in text

"""`course-kit class` with real gradings: killed, interrupted, and on a cluster; nothing is lost."""

from __future__ import annotations

import json
import os
import shutil
import signal
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit.cli.main import main
from tests.background import IN_BACKGROUND, started
from tests.waiting import wait_until

if TYPE_CHECKING:
    import subprocess

REPOSITORY = Path(__file__).resolve().parent.parent.parent
EXERCISE = "pattern_choice"  # which is graded fastest
SOLUTION = REPOSITORY / f"solutions/{EXERCISE}/{EXERCISE}.py"
CLASS_SIZE = 5
PATIENCE_S = 250.0  # against hanging only

pytestmark = pytest.mark.answers


@pytest.fixture
def handed_in(tmp_path: Path) -> Path:
    for number in range(CLASS_SIZE):
        folder = tmp_path / "in" / f"student{number}"
        folder.mkdir(parents=True)
        (folder / f"{EXERCISE}.py").write_text(f"{SOLUTION.read_text()}\n# of student {number}\n")
    return tmp_path / "in"


def slow_down(handed_in: Path) -> None:
    """Have each program begin late, so that a class is not over before somebody interrupts it."""
    for path in handed_in.glob("*/*.py"):
        path.write_text(f"import time\n\ntime.sleep(1.5)\n{path.read_text()}")


def class_run(handed_in: Path, *more: object) -> tuple[object, ...]:
    out = handed_in.parent / "out"
    return ("-m", "course_kit", "class", handed_in, "--exercise", EXERCISE, "--out", out, *more)


def records(handed_in: Path) -> dict[str, Path]:
    return {path.parent.name: path for path in (handed_in.parent / "out/students").glob("*/*.json")}


def finish(handed_in: Path, *more: object) -> None:
    """Run to the end, and see that everybody has full marks."""
    with started(*class_run(handed_in, *more)) as process:
        said, _ = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0, said
    scores = {name: json.loads(path.read_text())["report"]["score"] for name, path in records(handed_in).items()}
    assert scores == {f"student{number}": 10.0 for number in range(CLASS_SIZE)}


def test_ctrl_c_finishes_what_is_under_way_and_the_rest_comes_later(handed_in: Path) -> None:
    """Also where a script has started it in the background."""
    slow_down(handed_in)
    with started(*class_run(handed_in, "--workers", 1), by=IN_BACKGROUND) as process:
        wait_until(lambda: len(records(handed_in)) >= 1)
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    assert "running gradings have finished" in said
    assert "--resume" in said
    assert "Traceback" not in said
    assert 1 <= len(records(handed_in)) < CLASS_SIZE
    finish(handed_in, "--resume", "--workers", 2)


def test_names_steer_nothing_and_whoever_is_left_out_is_named(handed_in: Path) -> None:
    """Beside the others a name that is not UTF-8, and one with an escape sequence of whom there is only a link."""
    evil = "evil\x1b[31m\u202e"
    (handed_in / evil).symlink_to("student0")
    shutil.move(handed_in / "student1", os.fsencode(handed_in) + b"/j\xf6rg")
    for resume in ((), ("--resume",)):
        with started(*class_run(handed_in, *resume)) as process:
            said, _ = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 2, said
        assert "Traceback" not in said
        assert "1 student handed in something that was not graded: evil\ufffd[31m\ufffd (" in said
        assert "it is a link, and links are not followed" in said
        assert evil not in said
        assert len(records(handed_in)) == CLASS_SIZE
    grades = (handed_in.parent / "out/grades.csv").read_text(encoding="utf-8-sig")
    assert "j\ufffdrg,,10," in grades
    assert grades.count(",10,10,passed,") == CLASS_SIZE


def test_a_cluster_does_the_same_and_loses_nothing_with_a_machine(handed_in: Path, tmp_path: Path) -> None:
    """A real Dask scheduler and two worker processes; one is killed while it grades."""
    slow_down(handed_in)
    contact = tmp_path / "scheduler.json"
    with ExitStack() as cluster:
        scheduler = ("-m", "distributed.cli.dask_scheduler", "--port", 0, "--no-dashboard", "--host", "127.0.0.1")
        cluster.enter_context(started(*scheduler, "--scheduler-file", contact))
        wait_until(lambda: address_in(contact) is not None)
        worker = ("-m", "distributed.cli.dask_worker", "--scheduler-file", contact, "--nthreads", 1, "--no-nanny")
        workers = [cluster.enter_context(started(*worker, "--no-dashboard", "--name", name)) for name in "ab"]
        address = str(address_in(contact))
        for one in workers:
            wait_until_registered(one)
        process = cluster.enter_context(started(*class_run(handed_in, "--scheduler", address)))
        wait_until(lambda: len(records(handed_in)) >= 1)
        workers[0].kill()
        said, _ = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 0, said
    finish(handed_in, "--resume")


def test_a_scheduler_that_dies_is_said_with_the_command_that_goes_on(handed_in: Path, tmp_path: Path) -> None:
    slow_down(handed_in)
    contact = tmp_path / "scheduler.json"
    with ExitStack() as cluster:
        python = ("-m", "distributed.cli.dask_scheduler", "--port", 0, "--no-dashboard", "--host", "127.0.0.1")
        scheduler = cluster.enter_context(started(*python, "--scheduler-file", contact))
        wait_until(lambda: address_in(contact) is not None)
        worker = ("-m", "distributed.cli.dask_worker", "--scheduler-file", contact, "--nthreads", 1, "--no-nanny")
        wait_until_registered(cluster.enter_context(started(*worker, "--no-dashboard")))
        address = str(address_in(contact))
        process = cluster.enter_context(started(*class_run(handed_in, "--scheduler", address)))
        wait_until(lambda: len(records(handed_in)) >= 1)
        scheduler.kill()
        said, _ = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 2, said
    assert f"course-kit: The Dask scheduler at {address} has ended or cannot be reached." in said
    assert f"--scheduler {address} --resume" in said.partition("then run:\n")[2]
    assert "Traceback" not in said
    before = records(handed_in)
    assert 1 <= len(before) < CLASS_SIZE
    assert {json.loads(path.read_text())["report"]["status"] for path in before.values()} == {"graded"}
    finish(handed_in, "--resume")


def address_in(contact: Path) -> str | None:
    """Where the scheduler is; None until its file is there, and whole."""
    try:
        return str(json.loads(contact.read_text())["address"])
    except (OSError, ValueError):
        return None


def wait_until_registered(worker: subprocess.Popen[str]) -> None:
    """Until a worker says that the scheduler has it; a client that asks can hang in its handshake on a busy machine."""
    said: list[str] = []
    while not said or "Registered to:" not in said[-1]:
        said.append(worker.stdout.readline() if worker.stdout else "")
        assert said[-1], said


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        (["--scheduler", "tcp://127.0.0.1:9"], "no Dask scheduler at"),
        (["--layout", "blackbord"], "no layout 'blackbord'"),
        (["--out", __file__], "is a file. Give --out a folder"),
    ],
)
def test_what_cannot_be_done_is_said_in_one_line(
    handed_in: Path, more: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(word) for word in class_run(handed_in, *more)[2:]]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert "Traceback" not in said

"""One environment for each ROS; a new one takes the old one's place when it is whole, and harms no running program."""

from __future__ import annotations

import os
import signal
import subprocess
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.course_clone import BASE_PYTHON

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tests.course_clone import Clone

WAITS = "import sys; print('up', flush=True); sys.stdin.read()"


@contextmanager
def running(python: str | Path, folder: Path, **variables: str) -> Iterator[subprocess.Popen[str]]:
    """A program in an environment, as a JupyterLab is one: it waits until it is let go."""
    program = [python, "-c", WAITS]
    environ = {**os.environ, **variables}
    with subprocess.Popen(
        program, cwd=folder, env=environ, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "up\n"
        yield process
        assert process.poll() is None


def edit_pyproject(clone: Clone) -> None:
    with (clone.root / "pyproject.toml").open("a") as file:
        file.write("# edited\n")


def used(done: subprocess.CompletedProcess[str]) -> str:
    """The environment that a command ran in."""
    assert done.returncode == 0, done.stderr
    return done.stdout.split(" doctor")[0].removeprefix("cli ")


def test_terminals_with_and_without_a_sourced_ros_keep_their_environments(clone: Clone) -> None:
    without, sourced = used(clone.course("doctor")), used(clone.course("doctor", **clone.sourced()))
    assert without != sourced
    assert str(clone.environment) == sourced
    for _ in range(2):
        assert used(clone.course("doctor")) == without == str(clone.environment)
        assert used(clone.course("doctor", **clone.sourced())) == sourced == str(clone.environment)
    assert clone.calls() == ["venv", "pip", "venv", "pip"]


def test_while_one_terminal_sets_up_the_others_go_on(clone: Clone, tmp_path: Path) -> None:
    before = used(clone.course("doctor"))
    clone.course("doctor", **clone.sourced())
    started = clone.half_way(tmp_path, "test")
    try:
        assert used(clone.course("doctor", **clone.sourced())) != before
        assert used(clone.course("doctor")) == before
    finally:
        os.killpg(started.pid, signal.SIGKILL)
        started.communicate(timeout=120)
    assert used(clone.course("doctor")) == before


def test_an_update_leaves_the_environment_of_a_running_program_alone(clone: Clone) -> None:
    old = used(clone.course("doctor"))
    with running(f"{old}/bin/python", clone.root):
        edit_pyproject(clone)
        new = used(clone.course("doctor"))
        assert new != old
        assert {str(path) for path in clone.environments()} == {old, new}
    edit_pyproject(clone)
    newest = used(clone.course("doctor"))
    assert {str(path) for path in clone.environments()} == {new, newest}


@pytest.mark.parametrize(("number", "left"), [(signal.SIGINT, 1), (signal.SIGKILL, 3)])
def test_an_update_that_is_stopped_leaves_the_course_as_it_was(
    clone: Clone, tmp_path: Path, number: signal.Signals, left: int
) -> None:
    before = used(clone.course("doctor"))
    started = clone.half_way(tmp_path, "test")
    os.killpg(started.pid, number)
    started.communicate(timeout=120)
    assert len(clone.environments()) == left
    assert used(clone.course("doctor")) == before
    assert clone.calls() == ["venv", "pip", "venv", "pip"]
    assert clone.course("test").stderr.count("ready") == 1
    assert clone.environments() == {clone.environment, Path(before)}


def test_who_deletes_the_link_gets_a_new_environment(clone: Clone) -> None:
    old = used(clone.course("doctor"))
    (clone.root / ".venv").unlink()
    assert used(clone.course("doctor")) != old
    assert clone.calls() == ["venv", "pip", "venv", "pip"]
    assert clone.environments() == {clone.environment, Path(old)}


def test_another_python_can_be_chosen_later_and_survives_an_update(clone: Clone) -> None:
    old = used(clone.course("doctor"))
    (clone.tools / "chosen").symlink_to(BASE_PYTHON)
    chosen = str(clone.tools / "chosen")
    new = used(clone.course("doctor", COURSE_PYTHON=chosen))
    assert new != old
    assert used(clone.course("doctor", COURSE_PYTHON="")) == new
    clone.tool("python3", "#!/bin/sh\nexit 1\n")
    edit_pyproject(clone)
    newest = used(clone.course("doctor", COURSE_PYTHON=""))
    assert newest != new
    assert Path(newest, ".course-python").read_text() == f"{chosen}\n"


def test_a_virtual_environment_of_somebody_else_is_not_touched(clone: Clone) -> None:
    (clone.root / ".venv").mkdir()
    (clone.root / ".venv" / "precious").touch()
    refused = clone.course("doctor")
    assert refused.returncode == 2
    assert f"{clone.root}/.venv was not made by ./course" in refused.stderr
    assert len(refused.stderr.splitlines()) == 1
    assert (clone.root / ".venv" / "precious").exists()
    assert clone.calls() == []

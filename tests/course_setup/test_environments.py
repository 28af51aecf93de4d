"""One environment for each ROS; a new one takes the old one's place when it is whole, and harms no running program."""

from __future__ import annotations

import os
import signal
import subprocess
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.course_clone import BASE_PYTHON, STAND_IN_UV
from tests.environment.overwritten import overwrite_lark

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tests.course_clone import Clone

# Is killed when it makes a link: what led somewhere before has to lead there still.
KILLED_AT_A_LINK = """
import os, pathlib, signal, sys
from course_setup.environments import Environment, Environments
root, second = map(pathlib.Path, sys.argv[1:])
pathlib.Path.symlink_to = lambda *_: os.kill(os.getpid(), signal.SIGKILL)
Environments(root, "wheels").put_in_force(Environment(second))
"""
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


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


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
    assert clone.calls() == ["venv", "pip", "-m", "-m"]


def test_while_one_terminal_sets_up_the_others_go_on(clone: Clone, tmp_path: Path) -> None:
    before = used(clone.course("doctor"))
    clone.course("doctor", **clone.sourced())
    started = clone.half_way(tmp_path, "test")
    try:
        assert used(clone.course("doctor", **clone.sourced())) != before
        assert used(clone.course("doctor")) == before
    finally:
        os.killpg(started.pid, signal.SIGKILL)
        started.communicate(timeout=30)
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
    assert {str(path) for path in clone.environments()} == {newest}


def test_so_does_it_for_one_in_an_activated_terminal(clone: Clone) -> None:
    old = used(clone.course("doctor"))
    with running(BASE_PYTHON, clone.root, VIRTUAL_ENV=old):
        edit_pyproject(clone)
        clone.course("doctor")
        assert (clone.root / ".venvs").exists()
        assert old in {str(path) for path in clone.environments()}


def test_a_program_started_through_the_link_keeps_its_modules(clone: Clone) -> None:
    old = used(clone.course("doctor"))
    with running(".venv/bin/python", clone.root):
        edit_pyproject(clone)
        new = used(clone.course("doctor"))
        assert new != old
        assert str(clone.environment) == old
    assert used(clone.course("doctor")) == new == str(clone.environment)


@pytest.mark.parametrize(("number", "left"), [(signal.SIGINT, 1), (signal.SIGKILL, 3)])
def test_an_update_that_is_stopped_leaves_the_course_as_it_was(
    clone: Clone, tmp_path: Path, number: signal.Signals, left: int
) -> None:
    before = used(clone.course("doctor"))
    programs = contents(clone.environment / "bin")
    started = clone.half_way(tmp_path, "test")
    os.killpg(started.pid, number)
    started.communicate(timeout=30)
    assert len(clone.environments()) == left
    assert used(clone.course("doctor")) == before
    assert contents(clone.environment / "bin") == programs
    assert clone.calls() == ["venv", "pip", "pip"]
    assert clone.course("test").stderr.count("ready") == 1
    assert clone.environments() == {clone.environment}


def test_an_update_takes_over_programs_that_are_only_called_like_the_scripts_that_activate(clone: Clone) -> None:
    used(clone.course("doctor"))
    others = ("activate_this.py", "activate-global-completion")
    for name in others:
        (clone.environment / "bin" / name).write_text("kept\n")
    edit_pyproject(clone)
    new = Path(used(clone.course("doctor")))
    assert [(new / "bin" / name).read_text() for name in others] == ["kept\n", "kept\n"]
    assert f"{new}" in (new / "bin" / "activate").read_text()


def test_an_update_that_is_killed_at_the_last_step_leaves_the_course_as_it_was(clone: Clone) -> None:
    before = used(clone.course("doctor"))
    second = clone.root / ".venvs" / "wheels-second"
    second.mkdir()
    killed = subprocess.run([BASE_PYTHON, "-c", KILLED_AT_A_LINK, clone.root, second], cwd=clone.root, check=False)
    assert killed.returncode == -signal.SIGKILL
    assert str(clone.environment) == before
    assert used(clone.course("doctor")) == before
    assert clone.calls() == ["venv", "pip"]


def test_who_deletes_the_link_gets_a_new_environment(clone: Clone) -> None:
    old = used(clone.course("doctor"))
    (clone.root / ".venv").unlink()
    assert used(clone.course("doctor")) != old
    assert clone.calls() == ["venv", "pip", "venv", "pip"]
    assert clone.environments() == {clone.environment}


def test_a_new_environment_that_cannot_be_made_leaves_the_old_one(clone: Clone) -> None:
    old = used(clone.course("doctor"))
    (clone.root / ".venv").unlink()
    assert clone.course("doctor", STAND_IN_RESULT="1").returncode == 2
    assert [str(path) for path in clone.environments()] == [old]


def test_one_whose_python_was_removed_is_made_anew(clone: Clone) -> None:
    old = used(clone.course("doctor"))
    for name in ("python", "python3"):
        (clone.environment / "bin" / name).unlink(missing_ok=True)
        (clone.environment / "bin" / name).symlink_to("/usr/bin/python3.removed")
    assert used(clone.course("doctor")) != old


def test_another_python_can_be_chosen_later(clone: Clone, tmp_path: Path) -> None:
    old = used(clone.course("doctor"))
    same = tmp_path / "same_python"
    same.symlink_to(BASE_PYTHON)
    assert used(clone.course("doctor", COURSE_PYTHON=str(same))) == old
    clone.tool(
        "stand_in_other_python",
        f'#!/bin/sh\ncase $* in *base_prefix*) echo 3.10 ;; *) exec {BASE_PYTHON} "$@" ;; esac\n',
    )
    other = str(clone.tools / "stand_in_other_python")
    new = used(clone.course("doctor", COURSE_PYTHON=other))
    assert new != old
    assert f"--python {other}" in clone.log.read_text()
    assert used(clone.course("doctor", COURSE_PYTHON="")) == new


def test_test_tools_once_wanted_stay(clone: Clone) -> None:
    clone.course("test")
    edit_pyproject(clone)
    used(clone.course("doctor"))
    (clone.root / ".venv").unlink()
    used(clone.course("doctor"))
    installs = [line.split()[-1] for line in clone.log.read_text().splitlines() if " -e " in line]
    assert installs == [".[ros,test-ros,test]"] * 3


def test_a_virtual_environment_of_somebody_else_is_not_touched(clone: Clone) -> None:
    (clone.root / ".venv").mkdir()
    (clone.root / ".venv" / "precious").touch()
    refused = clone.course("doctor")
    assert refused.returncode == 2
    assert f"{clone.root}/.venv was not made by ./course" in refused.stderr
    assert len(refused.stderr.splitlines()) == 1
    assert (clone.root / ".venv" / "precious").exists()
    assert clone.calls() == []


def test_the_environment_of_an_older_version_makes_room_for_a_new_one(clone: Clone) -> None:
    (clone.root / ".venv").mkdir()
    (clone.root / ".venv" / ".course-stamp").touch()
    assert used(clone.course("doctor")) == str(clone.environment)
    assert clone.environments() == {clone.environment}


def test_a_package_that_another_has_overwritten_is_installed_again(clone: Clone, tmp_path: Path) -> None:
    """The stand-in for uv installs nothing by itself, so here it lays down a package that has lost a file."""
    overwrite_lark(tmp_path / "packages")
    lays_it_down = STAND_IN_UV.replace(
        "         pwd >", f'         cp -r "{tmp_path}/packages/." "$packages"\n         pwd >'
    )
    clone.tool("uv", lays_it_down)
    used(clone.course("doctor"))
    assert clone.log.read_text().splitlines()[-1].endswith("--force-reinstall --no-deps lark==1.3.1")

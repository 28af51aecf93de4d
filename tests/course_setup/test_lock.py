"""One set-up of a folder at a time; who waits is told for whom, and never waits for nobody."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_setup.environments import held
from course_setup.problems import SetUpError
from tests.course_clone import hear_ctrl_c

if TYPE_CHECKING:
    from pathlib import Path

    from tests.course_clone import Clone

HOLDS = """
import pathlib, sys
from course_setup.environments import held
with held(pathlib.Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


def another(clone: Clone) -> subprocess.Popen[str]:
    """One more `./course doctor`, of which only what it says is read."""
    return subprocess.Popen(
        [clone.root / "course", "doctor"],
        cwd=clone.root.parent,
        env=clone.environ(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=hear_ctrl_c,  # noqa: PLW1509 - it only sets a signal
    )


def test_the_second_waits_for_the_first_and_has_nothing_left_to_do(clone: Clone, tmp_path: Path) -> None:
    first = clone.half_way(tmp_path)
    with another(clone) as second:
        assert second.stderr is not None
        assert "waiting for another set-up of this folder." in second.stderr.readline()
        (tmp_path / "pipe").write_text("go on\n")
        output, errors = second.communicate(timeout=120)
    first.communicate(timeout=120)
    assert (first.returncode, second.returncode) == (0, 0)
    assert output == f"cli {clone.environment} doctor\n"
    assert errors == ""
    assert clone.calls() == ["venv", "pip"]


def test_ctrl_c_ends_the_waiting_and_not_the_set_up(clone: Clone, tmp_path: Path) -> None:
    first = clone.half_way(tmp_path)
    with another(clone) as second:
        assert second.stderr is not None
        second.stderr.readline()
        os.killpg(second.pid, signal.SIGINT)
        _, errors = second.communicate(timeout=120)
    assert second.returncode == 130
    assert "Traceback" not in errors
    (tmp_path / "pipe").write_text("go on\n")
    first.communicate(timeout=120)
    assert first.returncode == 0


def test_the_lock_dies_with_its_owner(tmp_path: Path) -> None:
    lock = tmp_path / "lock"
    owner = subprocess.Popen(
        [sys.executable, "-c", HOLDS, lock], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    with owner:
        assert owner.stdout is not None
        assert owner.stdout.readline() == "held\n"
        with pytest.raises(SetUpError), held(lock, patience_s=0.0):
            pytest.fail("two hold the lock")
        owner.kill()
        owner.wait(120)
        with held(lock, patience_s=0.0) as waited:
            assert not waited

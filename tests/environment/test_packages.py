"""Two packages that bring the same files: `lark`, and its old name `lark-parser`, which the ROS wheels ask for."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit.environment import packages
from tests.environment.overwritten import install_lark, overwrite_lark

if TYPE_CHECKING:
    from pathlib import Path


def look(folder: Path) -> str:
    """What is found by a Python that has the packages in the folder."""
    return subprocess.run(
        [sys.executable, "-m", "course_kit.environment.packages"],
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    ).stdout


def test_the_environment_of_these_tests_has_one_good_lark() -> None:
    assert packages.damaged() == {}
    done = subprocess.run([sys.executable, "-W", "error", "-c", "from lark import ParseTree"], check=False)
    assert done.returncode == 0


def test_a_whole_package_is_not_mentioned(tmp_path: Path) -> None:
    install_lark(tmp_path)
    assert look(tmp_path) == ""


@pytest.mark.parametrize("lost", [False, True])
def test_one_that_has_lost_a_file_to_another_is_named_with_its_version(lost: bool, tmp_path: Path) -> None:
    file = overwrite_lark(tmp_path)
    if lost:
        file.unlink()
    assert look(tmp_path) == "lark==1.3.1\n"


def test_the_remedy_is_a_command_for_this_python_and_this_package_alone() -> None:
    command = packages.remedy("lark==1.3.1")
    assert sys.executable in command
    assert command.endswith("--no-deps lark==1.3.1")

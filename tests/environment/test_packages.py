"""Two packages that bring the same files: `lark`, and its old name `lark-parser`, which the ROS wheels ask for."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

from course_kit.ros2cli import checkup
from tests.environment.overwritten import overwrite_lark

if TYPE_CHECKING:
    from pathlib import Path


def look(folder: Path) -> str:
    """What is found by a Python that has the packages in the folder."""
    return subprocess.run(
        [
            sys.executable,
            "-c",
            "from course_kit.ros2cli.checkup import find_damaged_package; print(find_damaged_package())",
        ],
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    ).stdout


def test_the_environment_of_these_tests_has_one_good_lark() -> None:
    assert checkup.find_damaged_package() == ""
    done = subprocess.run([sys.executable, "-W", "error", "-c", "from lark import ParseTree"], check=False)
    assert done.returncode == 0


def test_one_that_has_lost_a_file_to_another_is_named_with_its_version(tmp_path: Path) -> None:
    overwrite_lark(tmp_path)
    assert look(tmp_path) == "lark==1.3.1\n"

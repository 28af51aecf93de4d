"""The class command loads nothing that needs ROS: each grader runs in its own process."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

from tests.grading.conftest import EXERCISE, ROOT

if TYPE_CHECKING:
    from pathlib import Path

COMMAND = """
import sys
from course_kit.cli.main import main
code = main(["class", "in", "--exercise", {exercise!r}, "--out", "out"])
print(code, [name for name in ("rclpy", "numpy", "course_kit.graders") if name in sys.modules])
"""


def test_a_class_is_graded_without_loading_a_grader_or_ros(tmp_path: Path) -> None:
    """Doing so to find a grader's sources held the first verdict up by half a second."""
    folder = tmp_path / "in" / "ada"
    folder.mkdir(parents=True)
    name = f"{EXERCISE}.py"
    (folder / name).write_bytes((ROOT / "exercises" / EXERCISE / name).read_bytes())
    done = subprocess.run(
        [sys.executable, "-c", COMMAND.format(exercise=EXERCISE)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=110,
        check=False,
    )
    assert done.stdout.splitlines()[-1] == "0 []", done.stderr
    assert (tmp_path / "out" / "grades.csv").is_file()

"""`./course test` as a person or a script runs it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.background import IN_BACKGROUND

REPOSITORY = Path(__file__).resolve().parent.parent.parent
PRESSES_CTRL_C = "tests/course_setup/test_course_script.py::test_ctrl_c_half_way_says_so_and_the_next_run_goes_on"


def test_tests_that_press_ctrl_c_pass_where_a_script_started_the_suite_in_the_background() -> None:
    suite = [sys.executable, "-m", "course_kit.dev.suite", "-q", "-p", "no:cacheprovider", PRESSES_CTRL_C]
    done = subprocess.run(
        [*IN_BACKGROUND, *suite], cwd=REPOSITORY, capture_output=True, text=True, timeout=100, check=False
    )
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout

"""`./course test` as a script runs it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.background import IN_BACKGROUND

REPOSITORY = Path(__file__).resolve().parent.parent.parent
PRESSES_CTRL_C = (
    "import os, signal; from tests import conftest; os.kill(os.getpid(), signal.SIGINT); print('not heard')"
)


def test_tests_that_press_ctrl_c_are_heard_where_a_script_started_the_suite_in_the_background() -> None:
    done = subprocess.run(
        [*IN_BACKGROUND, sys.executable, "-c", PRESSES_CTRL_C],
        cwd=REPOSITORY, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert "KeyboardInterrupt" in done.stderr
    assert done.stdout == ""

"""`./course test` as a script runs it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from course_kit.dev import suite
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


@pytest.mark.parametrize("size", [[], ["--quick"]])
def test_notebooks_run_among_the_tests(size: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    runs: list[list[str]] = []
    monkeypatch.setattr(suite, "run_pytest", lambda arguments, _: runs.append(arguments))
    monkeypatch.setattr(suite, "find_or_install_browser", lambda: None)
    monkeypatch.chdir(REPOSITORY)
    assert suite.main(size) == 0
    lessons = Path("notebooks").glob("0[123]_*") if size else suite.list_with_outputs(Path())
    assert [runs[0][runs[0].index("--nbval") + 1 :]] == [["tests", *map(str, sorted(lessons))]]

"""One run at a time in one folder of results, whatever ends the run that has it."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom import run_folder
from course_kit.cli.main import main
from course_kit.grading import GradingError

if TYPE_CHECKING:
    from pathlib import Path

HOLDER = """
import subprocess, sys
from pathlib import Path
from course_kit.classroom import run_folder
with run_folder.hold_folder(Path(sys.argv[1])):
    child = subprocess.Popen(["sleep", "100"])
    print(child.pid, flush=True)
    sys.stdin.read()
"""


def test_a_second_run_is_told_who_has_the_folder_and_a_crash_gives_it_back(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Even where a child of the crashed run lives on."""
    out = tmp_path / "out"
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(out)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert holder.stdout is not None
    child = int(holder.stdout.readline())
    try:
        who = rf"at work in .*out: process {holder.pid} of \S+ on \S+, since 20\d\d-"
        with pytest.raises(GradingError, match=who), run_folder.hold_folder(out):
            pass
        (tmp_path / "in/ann").mkdir(parents=True)
        (tmp_path / "in/ann/pattern_choice.py").write_text("answers = {}")
        words = [str(tmp_path / "in"), "--exercise", "pattern_choice", "--out", str(out)]
        assert main(["class", *words]) == 2
        said = capsys.readouterr().err
        assert f"process {holder.pid} of" in said
        assert "Traceback" not in said
        assert not (out / "run.json").exists()
        holder.kill()
        holder.wait()
        with run_folder.hold_folder(out):
            os.kill(child, 0)  # it is still there
    finally:
        os.kill(child, 9)
        holder.kill()
        holder.communicate()

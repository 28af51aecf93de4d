"""What commands say to a terminal: nothing of a stranger's steers it; who grades as root is told so beforehand."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit.cli import main

if TYPE_CHECKING:
    from pathlib import Path

STEERING = "a\u202eb\u009b2Jc\x7fd\u2066e👩\u200d👧 ü"


def command(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "course_kit", *words], capture_output=True, text=True, timeout=100, check=False
    )


def test_json_on_a_terminal_is_printable_and_means_the_same(capsys: pytest.CaptureFixture[str]) -> None:
    main.print_json(json.dumps({STEERING: [STEERING]}, ensure_ascii=False, indent=2))
    printed = capsys.readouterr().out
    assert json.loads(printed) == {STEERING: [STEERING]}
    assert all(one.isprintable() or one == "\n" for one in printed)
    assert "ü" in printed


def test_the_name_of_a_file_does_not_steer_the_terminal(tmp_path: Path) -> None:
    done = command("grade", "temperature_service", str(tmp_path / "\x1b[2J\u202e.py"))
    assert done.returncode != 0
    for stream in (done.stdout, done.stderr):
        assert all(one.isprintable() or one == "\n" for one in stream), stream


@pytest.mark.parametrize(
    "words",
    [
        ["grade", "temperature_service", "no.py"],
        ["grade", "temperature_service", "no.py", "--format", "json"],
        ["class", "{folder}", "--exercise", "temperature_service", "--out", "{folder}/out"],
    ],
)
def test_who_grades_as_root_is_told_so_before_anything_is_graded(words: list[str], tmp_path: Path) -> None:
    done = command(*(word.format(folder=tmp_path) for word in words))
    assert done.returncode != 0  # there is nothing to grade
    first = (done.stderr.splitlines() or [""])[0]
    assert first.startswith("course-kit: you are grading as root. Use an ordinary account") == (os.geteuid() == 0)


def test_a_mistyped_command_is_answered_with_the_one_it_is_like(capsys: pytest.CaptureFixture[str]) -> None:
    assert main.main(["grad", "temperature_service"]) == 2
    said = capsys.readouterr().err
    assert "there is no command 'grad'. Did you mean grade?" in said
    assert "hub-singleuser" not in said  # nor any list of all that there is
    with pytest.raises(SystemExit, match="2"):
        main.main([])
    assert "show the exercises and your results" in capsys.readouterr().err

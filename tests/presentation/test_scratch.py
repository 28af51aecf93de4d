"""The folder of a presentation goes with it."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit.presentation.scratch import scratch_folder

if TYPE_CHECKING:
    from pathlib import Path

HOLDS_ONE = """
import sys, pathlib
from course_kit.presentation.scratch import scratch_folder
with scratch_folder(pathlib.Path(sys.argv[1])) as folder:
    (folder / "notebooks").mkdir()
    print(folder, flush=True)
    sys.stdin.read()
"""


def folders(parent: Path) -> list[Path]:
    return [path for path in parent.iterdir() if path.is_dir()]


def test_it_is_removed_with_what_is_in_it_even_if_that_is_read_only(tmp_path: Path) -> None:
    with scratch_folder(tmp_path) as folder:
        (folder / "notebooks").mkdir()
        (folder / "notebooks/a.ipynb").touch()
        (folder / "notebooks").chmod(0o500)
        assert folders(tmp_path) == [folder]
    assert folders(tmp_path) == []


def test_it_is_removed_when_the_presentation_fails(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), scratch_folder(tmp_path):
        raise KeyboardInterrupt
    assert folders(tmp_path) == []


def test_what_a_killed_one_left_is_removed_and_a_living_ones_stays(tmp_path: Path) -> None:
    (tmp_path / "notebooks").mkdir()  # of a version that had but one folder
    with subprocess.Popen(
        [sys.executable, "-c", HOLDS_ONE, tmp_path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as other:
        assert other.stdout
        theirs = tmp_path / other.stdout.readline().strip()
        with scratch_folder(tmp_path) as mine:
            assert sorted(folders(tmp_path)) == sorted([theirs, mine])
        other.kill()
    assert folders(tmp_path) == [theirs]
    with scratch_folder(tmp_path) as mine:
        assert folders(tmp_path) == [mine]

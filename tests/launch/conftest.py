"""Runs launch files in this process; what they start are programs that end at once."""

from __future__ import annotations

from io import StringIO
from typing import TYPE_CHECKING

import pytest

from course_kit.launch.errors import LaunchError
from course_kit.launch.service import LaunchService

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


HEAD = """
import sys
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.launch_description_sources import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.parameter_descriptions import *
from launch_ros.substitutions import *
import launch, launch_ros

def say(*words):
    return LogInfo(msg=list(words))

def generate_launch_description():
    return LaunchDescription([
{actions}
    ])
"""
FIRST_LINE = HEAD.partition("{actions}")[0].count("\n") + 1  # the line of the first action
TELL = """
import sys
print("told", sys.argv[1:])
for word, value in zip(sys.argv, sys.argv[1:]):
    if word == "--params-file":
        print(open(value).read())
"""


@pytest.fixture
def folder(tmp_path: Path, domain: int, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with a program `tell` that prints what it is told."""
    assert domain
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    monkeypatch.setattr("course_kit.environment.run_dir", lambda *names: tmp_path.joinpath("run", *names))
    (tmp_path / "tell.py").write_text(TELL)
    return tmp_path


@pytest.fixture
def run(folder: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Runs actions, or a whole file; what is on the screen then, with the sentence of a launch that fails."""

    def run_it(actions: str = "", *, text: str | None = None, file: str = "it.launch.py", **arguments: str) -> str:
        path = folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(HEAD.replace("{actions}", actions) if text is None else text)
        try:
            ended = f"ended with {LaunchService(StringIO()).run(path, arguments)}"
        except LaunchError as error:
            ended = f"failed: {error}"
        shown = capsys.readouterr()
        return f"{shown.out}{shown.err}{ended}"

    return run_it

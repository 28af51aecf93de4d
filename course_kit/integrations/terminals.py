"""The terminals of JupyterLab: they find the course's Python and `ros2`, and complete `ros2` with Tab.

A login shell's /etc/profile and the user's own files set PATH anew, so it is put right after them.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Mapping

START_FILE = Path(__file__).with_name("terminal.bash")
_LIKE_BASH = ("", "sh", "bash", "dash")  # whose users are at home in bash


def variables() -> dict[str, str]:
    """What the start file reads."""
    return {"COURSE_KIT_SCRIPTS": str(environment.paths.scripts_folder())}


def shell_command(*, login: bool = False) -> list[str] | None:
    """The command of a terminal, None where there is no bash."""
    bash = shutil.which("bash")
    if bash is None:
        return None
    if login:
        return [bash, "-l", "-c", 'exec "$0" --rcfile "$1"', bash, str(START_FILE)]
    return [bash, "--rcfile", str(START_FILE)]


def prefers_bash(environ: Mapping[str, str] = os.environ) -> bool:
    """Whether a user would rather have bash than the shell that SHELL names."""
    return Path(environ.get("SHELL", "")).name in _LIKE_BASH

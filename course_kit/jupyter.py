"""Starts JupyterLab on the course."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Sequence
FIRST_LESSON = "notebooks/00_welcome.ipynb"
TERMINAL = Path(__file__).with_name("terminal.bash")


def run_lab(arguments: Sequence[str]) -> int:
    """Replace this process by JupyterLab, opened on the first lesson; return 2 where there is no course folder.

    The settings of the course are in its environment, so kernels and terminals all join the same ROS graph.
    """
    root = environment.checkout()
    if root is None:
        print("course-kit: the notebooks are not here. Run ./course lab in the course's folder.", file=sys.stderr)
        return 2
    return serve(root, FIRST_LESSON, arguments)


def serve(root: Path, first: str, arguments: Sequence[str], **variables: str) -> int:
    """Replace this process by JupyterLab.

    Args:
        root: the folder it shows.
        first: the notebook it opens, relative to `root`.
        arguments: more for `jupyter lab`.
        variables: more for its environment.
    """
    command = [
        sys.executable,
        "-m",
        "jupyter",
        "lab",
        f"--ServerApp.root_dir={root}",
        f"--LabApp.default_url=/lab/tree/{first}",
        *_terminals(),
        *arguments,
    ]
    return os.execve(sys.executable, command, environment.child_environment(**variables))


def _terminals() -> list[str]:
    """Have terminals find the course's Python and complete `ros2` with Tab, whatever the user's own set-up does."""
    bash = shutil.which("bash")
    if bash is None:
        return []
    settings = {"shell_command": [bash, "--rcfile", str(TERMINAL)]}
    return [f"--ServerApp.terminado_settings={settings}"]

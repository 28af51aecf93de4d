"""PATH: the programs of the Python that the course runs in come first, `ros2` and `python` among them.

Who starts a kernel or a server by its full path (a hub, VS Code, nbclient) does not put them there.
"""

from __future__ import annotations

import os
import site
import sys
from pathlib import Path


def scripts_folder() -> Path:
    """Where the installer has put `ros2` and `course-kit`: beside Python, or with `pip install --user` at home."""
    beside = Path(sys.prefix) / "bin"
    at_home = Path(site.getuserbase()) / "bin"
    return at_home if (at_home / "ros2").is_file() and not (beside / "ros2").is_file() else beside


def with_scripts_first(path: str | None) -> str:
    """A value for PATH that begins with that folder.

    A real `ros2` further behind is not hidden by it: the course's own steps aside for it.
    """
    first = str(scripts_folder())
    folders = (path or os.defpath).split(os.pathsep)
    return os.pathsep.join([first, *(folder for folder in folders if folder != first)])


def put_scripts_first() -> None:
    """Have this process, and all that it starts, find those programs first."""
    os.environ["PATH"] = with_scripts_first(os.environ.get("PATH"))

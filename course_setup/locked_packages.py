"""The lock: for each package that a set-up installs its version and the hashes of its files.

So a learner gets what was tested, and an installer refuses a file that is another one. `course-kit dev lock` writes
the lock, as requirement files with hashes, one for each extra in pyproject.toml, which pip and uv both read.
pylock.toml (PEP 751) and uv.lock could not be used: they write down the URL of each file, so that an installation
through a school's own mirror would not find them.
"""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

FOLDER = Path("course_setup", "locked")
_OLDEST_NUMPY = (1, 26)  # pyproject.toml asks for it
# Nothing is loaded from the folder that one is in, where strangers' programs may lie.
_VERSION_OF_NUMPY = (
    "import sys; sys.path[:] = filter(None, sys.path); import numpy; print(*numpy.__version__.split('.')[:2])"
)


def pip() -> list[str]:
    """The words that have any pip, even an old one, install the one of the lock."""
    return _checked(["pip"])


def packages(extras: Sequence[str], numpy: str) -> list[str]:
    """The words that have an installer install the packages of the lock and nothing else.

    Args:
        extras: those of pyproject.toml that are wanted beside what the course always needs.
        numpy: the name of the file for numpy, as `numpy_beside` tells; "" where none is needed.
    """
    return _checked(["pip", "course", *([numpy] if numpy else []), *extras])


def build_tools() -> str:
    """The file with the packages that build others."""
    return str(FOLDER / "build.txt")


def _checked(names: Sequence[str]) -> list[str]:
    return ["--no-deps", "--require-hashes", *(word for name in names for word in ("-r", str(FOLDER / f"{name}.txt")))]


def numpy_beside(version: tuple[int, ...] | None) -> str:
    """Which numpy to install beside the one of a sourced ROS 2: its messages are compiled for numpy 1 or for 2.

    Args:
        version: of ROS's numpy; None where there is none.

    Returns:
        The name of a file of the lock, or "" where ROS's own does.
    """
    return "" if version is not None and version >= _OLDEST_NUMPY else "numpy-1"


def version_of_numpy(python: str) -> tuple[int, ...] | None:
    """Major and minor version of the numpy that a Python finds, or None."""
    asked = subprocess.run([python, "-c", _VERSION_OF_NUMPY], capture_output=True, text=True, check=False)
    if asked.returncode:
        return None
    try:
        return tuple(map(int, asked.stdout.split()))
    except ValueError:
        return None

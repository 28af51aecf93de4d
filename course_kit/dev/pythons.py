"""The Pythons that the course is for, and uv."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

OLDEST, NEWEST = (3, 10), (3, 14)


def wanted() -> list[str]:
    """The versions that the course is for, oldest first, such as "3.10"."""
    return [f"{OLDEST[0]}.{minor}" for minor in range(OLDEST[1], NEWEST[1] + 1)]


def find_uv() -> str | None:
    """The uv of this environment, or the one on PATH; None where there is none."""
    return shutil.which("uv", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))

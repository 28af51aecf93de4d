"""Packages whose files another package has overwritten, and how to put them right.

`ros-rosidl-parser` asks for `lark-parser`, the old name of `lark`. Both put their files into the folder `lark`, where
those that are installed last stay, or, with an installer that works side by side, some of each. uv is told in
pyproject.toml not to install the old one; pip cannot be told.

`python -m course_kit.environment.packages` prints the requirement of each package to install again, one a line.
"""

from __future__ import annotations

import base64
import hashlib
import importlib.util
import shlex
import sys
from importlib import metadata
from pathlib import Path

_OVERWRITTEN = {"lark": "lark-parser"}  # package that is needed: package that overwrites it


def damaged() -> dict[str, str]:
    """The packages that have lost files: each as a requirement such as "lark==1.3.1", with the package to blame."""
    found = {}
    for name, other in _OVERWRITTEN.items():
        try:
            distribution = metadata.distribution(name)
        except metadata.PackageNotFoundError:  # of a real ROS 2, which brings its own
            continue
        if not all(map(_is_whole, distribution.files or [])):
            found[f"{name}=={distribution.version}"] = other
    return found


def remedy(requirement: str) -> str:
    """The command that installs a package of this Python again, and nothing else."""
    command = [sys.executable, "-m", "pip", "install", "--force-reinstall"]
    if importlib.util.find_spec("pip") is None:  # environments made by uv have none
        command = ["uv", "pip", "install", "--python", sys.executable, "--reinstall"]
    return shlex.join([*command, "--no-deps", requirement])


def _is_whole(recorded: metadata.PackagePath) -> bool:
    """Whether a file is the one that was installed."""
    if recorded.suffix != ".py" or recorded.hash is None:
        return True
    try:
        content = Path(recorded.locate()).read_bytes()
    except OSError:
        return False
    digest = hashlib.new(recorded.hash.mode, content).digest()
    return base64.urlsafe_b64encode(digest).rstrip(b"=").decode() == recorded.hash.value


if __name__ == "__main__":
    for wanted in damaged():
        print(wanted)  # noqa: T201 - for ./course

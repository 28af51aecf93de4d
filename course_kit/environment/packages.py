"""Packages whose files another package has overwritten, and how to put them right.

`ros-rosidl-parser` asks for `lark-parser`, the old name of `lark`. Both put their files into the folder `lark`, where
those that are installed last stay, or, with an installer that works side by side, some of each. uv is told in
pyproject.toml not to install the old one; pip cannot be told.

`python -m course_kit.environment.packages` prints the requirement of each package to install again, one a line.
"""

from __future__ import annotations

import base64
import csv
import hashlib
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
        if not _is_whole(distribution):
            found[f"{name}=={distribution.version}"] = other
    return found


def remedy(requirement: str) -> str:
    """The command that installs a package of this Python again, and nothing else."""
    command = [sys.executable, "-m", "pip", "install", "--force-reinstall"]
    if not _has_pip():  # environments made by uv have none
        command = ["uv", "pip", "install", "--python", sys.executable, "--reinstall"]
    return shlex.join([*command, "--no-deps", requirement])


def _has_pip() -> bool:
    try:
        metadata.distribution("pip")
    except metadata.PackageNotFoundError:
        return False
    return True


def _is_whole(distribution: metadata.Distribution) -> bool:
    """Whether its programs are the ones that were installed.

    `distribution.files` would not do: since Python 3.12 it leaves out those that are missing.
    """
    for name, checksum, _ in csv.reader((distribution.read_text("RECORD") or "").splitlines()):
        algorithm, _, expected = checksum.partition("=")
        if not name.endswith(".py") or not expected:
            continue
        try:
            content = Path(str(distribution.locate_file(name))).read_bytes()
        except OSError:
            return False
        digest = hashlib.new(algorithm, content).digest()
        if base64.urlsafe_b64encode(digest).rstrip(b"=").decode() != expected:
            return False
    return True


if __name__ == "__main__":
    for wanted in damaged():
        print(wanted)  # noqa: T201 - for ./course

"""Packages whose files another package has overwritten, and how to put them right.

`ros-rosidl-parser` asks for `lark-parser`, the old name of `lark`. Both put their files into the folder `lark`, where
those that are installed last stay. uv is told in pyproject.toml not to install the old one; pip cannot be told.
"""

from __future__ import annotations

import shlex
import sys
from importlib import import_module, metadata

_OVERWRITTEN = {"lark": "lark-parser"}  # package that is needed: package that overwrites it


def damaged() -> dict[str, str]:
    """The packages that have lost files: each as a requirement such as "lark==1.3.1", with the package to blame."""
    found = {}
    for name, other in _OVERWRITTEN.items():
        try:
            wanted = metadata.version(name)
        except metadata.PackageNotFoundError:  # of a real ROS 2, which brings its own
            continue
        try:
            there = import_module(name).__version__
        except (ImportError, AttributeError):
            there = ""
        if there != wanted:
            found[f"{name}=={wanted}"] = other
    return found


def remedy(requirement: str) -> str:
    """The command that installs a package of this Python again, and nothing else."""
    try:
        metadata.distribution("pip")
    except metadata.PackageNotFoundError:  # environments made by uv have none
        command = ["uv", "pip", "install", "--python", sys.executable, "--reinstall"]
    else:
        command = [sys.executable, "-m", "pip", "install", "--force-reinstall"]
    return shlex.join([*command, "--no-deps", requirement])

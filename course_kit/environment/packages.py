"""`lark`, whose files `lark-parser` overwrites: its old name, which `ros-rosidl-parser` asks for.

pyproject.toml keeps uv from installing that; whoever installs the kit's wheel with pip gets both.
"""

from __future__ import annotations

import shlex
import sys
from contextlib import suppress
from importlib import import_module, metadata

OLD_NAME = "lark-parser"


def find_damaged_package() -> str:
    """The requirement of a package that has lost files, "lark==1.3.1"; empty where all are whole."""
    with suppress(metadata.PackageNotFoundError, ImportError):  # an installed ROS 2 brings its own
        wanted = metadata.version("lark")
        return "" if getattr(import_module("lark"), "__version__", "") == wanted else f"lark=={wanted}"
    return ""


def reinstall_command(requirement: str) -> str:
    """The command that installs a package of this Python again, and nothing else; uv makes environments without pip."""
    pip = [sys.executable, "-m", "pip", "install", "--force-reinstall"]
    uv = ["uv", "pip", "install", "--python", sys.executable, "--reinstall"]
    return shlex.join([*(pip if any(metadata.distributions(name="pip")) else uv), "--no-deps", requirement])

"""Interfaces that are really installed, as the ament index lists them, with their text.

The index is a folder of plain files (see "ament_index" among the ROS 2 packages), so it is read here without
importing anything: one file a package, one line an interface.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress

from course_kit.interfaces.sources import KINDS, first_text, folders

_INDEX = os.path.join("share", "ament_index", "resource_index", "rosidl_interfaces")  # noqa: PTH118 - light at start


def prefixes() -> list[str]:
    """The folders ROS packages are installed below: those of a sourced ROS 2, and this Python's own."""
    sourced = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return list(dict.fromkeys(folder for folder in (*sourced, sys.prefix) if folder))


def installed_packages() -> set[str]:
    """The packages that install interfaces."""
    found: set[str] = set()
    for prefix in prefixes():
        with suppress(OSError):
            found.update(os.listdir(os.path.join(prefix, _INDEX)))  # noqa: PTH118, PTH208
    return found


def installed_types(package: str) -> set[str]:
    """The full names of a package's interfaces, such as "std_srvs/srv/SetBool"."""
    listed = first_text(prefixes(), _INDEX, package) or ""  # the first that has it hides the others, as with ament
    lines = (line.rpartition(".") for line in listed.split())
    return {f"{package}/{stem}" for stem, _, ending in lines if ending in KINDS}


def installed_text(package: str, kind: str, name: str) -> str | None:
    """The definition of an installed interface, None when there is no such."""
    return first_text(prefixes(), "share", package, kind, f"{name}.{kind}")


def idl_file(package: str, name: str) -> str | None:
    """The file of a message that is written in IDL; None when there is no such."""
    shares = (os.path.join(prefix, "share") for prefix in prefixes())  # noqa: PTH118
    files = (os.path.join(place, package, "msg", f"{name}.idl") for place in (*folders(), *shares))  # noqa: PTH118
    return next((file for file in files if os.path.isfile(file)), None)  # noqa: PTH113

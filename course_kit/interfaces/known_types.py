"""Every interface that can be used here, live or compiled: listing them, and finding one by its name."""

from __future__ import annotations

import importlib
import os
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from course_kit.interfaces import hints, sources
from course_kit.interfaces.errors import InterfaceNotFoundError
from course_kit.interfaces.sources import KINDS, first_text, source_folders

if TYPE_CHECKING:
    from collections.abc import Sequence

_INDEX = os.path.join("share", "ament_index", "resource_index", "rosidl_interfaces")  # noqa: PTH118 - light at start


def package_prefixes() -> list[str]:
    """The folders ROS packages are installed below: those of a sourced ROS 2, and this Python's own."""
    sourced = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return list(dict.fromkeys(folder for folder in (*sourced, sys.prefix) if folder))


def installed_packages() -> set[str]:
    """The packages that install interfaces."""
    found: set[str] = set()
    for prefix in package_prefixes():
        with suppress(OSError):
            found.update(os.listdir(os.path.join(prefix, _INDEX)))  # noqa: PTH118, PTH208
    return found


def installed_types(package: str) -> set[str]:
    """The full names of a package's interfaces, such as "std_srvs/srv/SetBool"."""
    # The first that has it hides the others, as with ament.
    listed = first_text(package_prefixes(), _INDEX, package) or ""
    lines = (line.rpartition(".") for line in listed.split())
    return {f"{package}/{stem}" for stem, _, ending in lines if ending in KINDS}


def installed_text(package: str, kind: str, name: str) -> str | None:
    """The definition of an installed interface, None when there is no such."""
    return first_text(package_prefixes(), "share", package, kind, f"{name}.{kind}")


def idl_file(package: str, name: str) -> str | None:
    """The file of a message that is written in IDL; None when there is no such."""
    shares = (os.path.join(prefix, "share") for prefix in package_prefixes())  # noqa: PTH118
    files = (os.path.join(place, package, "msg", f"{name}.idl") for place in (*source_folders(), *shares))  # noqa: PTH118
    return next((file for file in files if os.path.isfile(file)), None)  # noqa: PTH113


_PARTS_SHORT, _PARTS_FULL = 2, 3


def packages() -> list[str]:
    """The packages that have interfaces, sorted."""
    return sorted(installed_packages() | sources.live_packages())


def types(package: str | None = None, kind: str | None = None) -> list[str]:
    """Full names such as "std_srvs/srv/SetBool", sorted.

    Args:
        package: only those of this package.
        kind: only "msg", "srv" or "action".

    Raises:
        InterfaceNotFoundError: no such package has interfaces.
    """
    known = packages()
    if package is not None and package not in known:
        reason = f"No package {package!r} with interfaces is installed or defined."
        raise InterfaceNotFoundError(package, hints.nearest_name(package, known), reason)
    found = {name for each in ([package] if package else known) for name in _types_of(each)}
    return sorted(name for name in found if kind in (None, name.split("/")[1]) and _can_name(name.split("/")[2]))


def get_type(type_name: str) -> type[Any]:
    """The class of an interface, compiled or live.

    Args:
        type_name: "std_srvs/srv/SetBool", or "std_srvs/SetBool" where that is unambiguous.

    Raises:
        InterfaceNotFoundError: there is no such interface; the error names the nearest.
        InterfaceDefinitionError: it is defined, and its definition is not valid.
    """
    package, kind, name = full_name(type_name).split("/")
    try:
        cls: type[Any] = getattr(importlib.import_module(f"{package}.{kind}"), name)
    except (ImportError, AttributeError) as error:
        reason = f"The interface {type_name!r} is listed as installed but cannot be imported: {error}."
        raise InterfaceNotFoundError(type_name, None, reason) from error
    return cls


def text_of(type_name: str) -> str:
    """The text of an interface's definition, compiled types included.

    Raises:
        InterfaceNotFoundError: there is no such interface.
    """
    name = full_name(type_name)
    package, kind, base = name.split("/")
    text = None
    if package not in installed_packages():
        text = sources.find_text(package, kind, base)
    text = text if text is not None else installed_text(package, kind, base)
    if text is None:
        raise InterfaceNotFoundError(type_name, None, f"The definition of {name!r} is not installed with it.")
    return text


def full_name(type_name: str) -> str:
    """The full name of an existing interface given by its full or two-part name."""
    parts = type_name.strip().split("/")
    if len(parts) not in (_PARTS_SHORT, _PARTS_FULL) or not all(parts):
        reason = f"{type_name!r} is not an interface name: expected package/srv/Name, such as std_srvs/srv/SetBool."
        raise InterfaceNotFoundError(type_name, _nearest_type(parts), reason)
    kinds = [kind for kind in sources.KINDS if len(parts) == _PARTS_SHORT or kind == parts[1]]
    fitting = [name for name in _types_of(parts[0], kinds) if _fits(name.split("/"), parts)]
    if len(fitting) > 1:
        choice = " or ".join(repr(name) for name in sorted(fitting))
        raise InterfaceNotFoundError(type_name, None, f"{type_name!r} could be {choice}: use the full name.")
    if not fitting:
        raise InterfaceNotFoundError(type_name, _nearest_type(parts))
    if not _can_name(fitting[0].split("/")[2]):
        from course_kit.interfaces.parser import parse_type_name

        parse_type_name(fitting[0])  # a file is there, and says nothing about a name that no type can have
    return fitting[0]


def _can_name(name: str) -> bool:
    return name.isalnum() and name[0].isupper()


def _fits(name: list[str], wanted: list[str]) -> bool:
    return name == wanted or (len(wanted) == _PARTS_SHORT and [name[0], name[2]] == wanted)


def _nearest_type(parts: list[str]) -> str | None:
    """The most similar full name: same name in another folder or package first."""
    known = types()
    same = [name for name in known if name.split("/")[2].lower() == parts[-1].lower()]
    text = "/".join(parts)
    return hints.nearest_name(text, same) or hints.nearest_name(text, known) or next(iter(same), None)


def _types_of(package: str, kinds: Sequence[str] = sources.KINDS) -> set[str]:
    """An installed package hides a live one of the same name, as it does on import."""
    installed = installed_types(package)
    if installed:
        return installed
    return {f"{package}/{kind}/{name}" for kind in kinds for name in sources.live_names(package, kind)}

"""Whether the private and version-bound names that the kit touches are there, and what is off where one is not.

The lab asks when it starts ROS, and the doctor asks for all. Whoever uses such a name asks `Compatibility.has` first
and does without; so a missing name costs one feature and one sentence, and never the lab.
"""

from __future__ import annotations

import importlib
import sys
from contextlib import suppress
from types import FunctionType
from typing import TYPE_CHECKING

from course_kit.ros.compat_names import ALL, OF_THE_LAB, Feature

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

_ENDING = "; everything else works."


class Compatibility:
    """What was found in this process."""

    def __init__(self, missing: Mapping[Feature, tuple[str, ...]]) -> None:
        self._missing = dict(missing)

    def has(self, feature: Feature) -> bool:
        """Whether a feature has all its names."""
        return feature not in self._missing

    def sentences(self) -> list[str]:
        """What is off and why, a sentence for each feature."""
        return [f"{feature.lost}: {_absent(names)}{_ENDING}" for feature, names in self._missing.items()]


def check(features: Iterable[Feature] = OF_THE_LAB) -> Compatibility:
    """Look for the names of these features, as far as their packages are loaded; those of others count as there."""
    missing = {feature: tuple(name for name in feature.names if not is_there(name)) for feature in features}
    return Compatibility({feature: names for feature, names in missing.items() if names})


def check_all() -> Compatibility:
    """Load the packages of the table, as far as they are installed, and look for every name."""
    for package in sorted({name.partition(":")[0].partition(".")[0] for feature in ALL for name in feature.names}):
        with suppress(ModuleNotFoundError):
            importlib.import_module(package)
    return check(ALL)


def is_there(name: str) -> bool:
    """Whether a name of the table can be used; one whose package is not loaded is in nobody's way."""
    module, _, attributes = name.partition(":")
    if module.partition(".")[0] not in sys.modules:
        return True
    try:
        found = importlib.import_module(module)  # rclpy and IPython have loaded theirs: this only looks
        *path, last = attributes.split(".")
        for step in path:
            found = getattr(found, step)
    except (ImportError, AttributeError):
        return False
    return hasattr(found, last) or last in _names_in(found)


def rcl_error() -> type[BaseException]:
    """The exception of ROS's C library; one that is never raised where rclpy does not show it."""
    try:
        from rclpy.impl.implementation_singleton import rclpy_implementation

        found: type[BaseException] = rclpy_implementation.RCLError
    except (ImportError, AttributeError):
        return _NeverRaised
    return found


class _NeverRaised(Exception):  # noqa: N818 - it is none
    pass


def _names_in(found: object) -> set[str]:
    """What the code of a function names and calls its variables; of a class, what its methods do."""
    if isinstance(found, FunctionType):
        return {*found.__code__.co_names, *found.__code__.co_varnames}
    if not isinstance(found, type):
        return set()
    return {name for kind in found.__mro__ for value in vars(kind).values() for name in _names_in_method(value)}


def _names_in_method(value: object) -> Iterator[str]:
    parts = (value.fget, value.fset) if isinstance(value, property) else (value,)
    for part in parts:
        if isinstance(part, FunctionType):
            yield from part.__code__.co_names


def _absent(names: tuple[str, ...]) -> str:
    """Which names a package does not have, and in which version."""
    package = names[0].partition(":")[0].partition(".")[0]
    shown = ", ".join(name.replace(":", ".") for name in names)
    return f"{package}{_version(package)} has no {shown}"


def _version(package: str) -> str:
    from importlib import metadata  # takes longer to load than the whole check

    for distribution in (f"ros-{package.replace('_', '-')}", package):
        with suppress(metadata.PackageNotFoundError):
            return f" {metadata.version(distribution)}"
    return ""

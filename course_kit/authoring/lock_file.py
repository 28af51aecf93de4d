"""Reads the lock of the set-up: requirement files with hashes, as `course-kit dev lock` writes them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from packaging.markers import Marker

if TYPE_CHECKING:
    from collections.abc import Iterable

FOLDER = Path("course_setup/locked")
_PACKAGE = re.compile(r"(?P<name>[a-z0-9-]+)==(?P<version>[^ ;]+)(?: ; (?P<marker>.+))?")
_MICROS = (0, 99)  # some packages tell 3.11.4 from 3.11.5
_NEXT_LINE = re.compile(r"\s*\\\n\s*")


@dataclass(frozen=True)
class LockedPackage:
    """A package that a set-up installs."""

    name: str  # as PyPI spells it, in small letters
    version: str  # the one version
    marker: str  # on which Pythons it is installed; "" for all
    hashes: tuple[str, ...]  # of its files, each as "sha256:..."

    def is_for(self, python: str, system: str = "Linux") -> bool:
        """Whether it is installed on a Python such as "3.12" and a system, with the processor of the ROS 2 wheels."""
        return not self.marker or any(_holds(self.marker, python, micro, system) for micro in _MICROS)

    def line(self, *, with_marker: bool = True) -> str:
        """The package as an installer reads it."""
        marker = f" ; {self.marker}" if self.marker and with_marker else ""
        return " \\\n    ".join([f"{self.name}=={self.version}{marker}", *(f"--hash={one}" for one in self.hashes)])


def _holds(marker: str, python: str, micro: int, system: str) -> bool:
    environment = {
        "python_version": python,
        "python_full_version": f"{python}.{micro}",
        "sys_platform": system.lower(),
        "platform_system": system,
        "platform_machine": "x86_64",
        "implementation_name": "cpython",
        "platform_python_implementation": "CPython",
    }
    return Marker(marker).evaluate(environment)


def parse(text: str) -> list[LockedPackage]:
    """The packages of a requirement file with hashes."""
    packages = []
    for line in _NEXT_LINE.sub(" ", text).splitlines():
        if not line or line.startswith("#"):
            continue
        wanted, *hashes = line.split(" --hash=")
        found = _PACKAGE.fullmatch(wanted.strip())
        if found is None or not hashes:
            raise ValueError(f"This is no version with hashes: {wanted}")
        packages.append(LockedPackage(found["name"], found["version"], found["marker"] or "", tuple(hashes)))
    return packages


def read(root: Path, names: Iterable[str]) -> list[LockedPackage]:
    """The packages of several files of the lock, in their order."""
    return [package for name in names for package in parse((root / FOLDER / f"{name}.txt").read_text(encoding="utf-8"))]

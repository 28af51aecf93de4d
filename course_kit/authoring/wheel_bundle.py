"""Downloads every file a set-up needs, so that it can be done where there is no network.

The files are those of the lock, checked by their hashes. pip asks for another Python's files, but reads markers for
its own; so they are read here.
"""

from __future__ import annotations

import platform
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from packaging.markers import Marker
from packaging.tags import cpython_tags

from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

_PARTS = ("uv", "pip", "course", "numpy", "ros", "build")
_TEST_PARTS = ("test-ros", "test")
_ONLY_AS_SOURCE = "empy"  # its people make no wheel; it is Python alone, and the bundle has what builds it
_GLIBC = range(28, 4, -1)  # from 2.28, which `./course` asks for, down to the oldest that wheels are made for
# As `-m pip`, which would put the folder that one is in before pip's own.
_PIP = (
    "import sys; sys.path[:] = filter(None, sys.path); import runpy; "
    "runpy.run_module('pip', run_name='__main__', alter_sys=True)"
)
_DEADLINE_S = 3600.0
_MB = 2**20

LOCK = Path("course_setup/locked")
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
        return " \\\n    ".join([f"{self.name}=={self.version}{marker}", *(f"--hash={sha}" for sha in self.hashes)])


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


def parse_lock(text: str) -> list[LockedPackage]:
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


def read_lock(root: Path, names: Iterable[str]) -> list[LockedPackage]:
    """The packages of several files of the lock, in their order."""
    try:
        texts = [(root / LOCK / f"{name}.txt").read_text(encoding="utf-8") for name in names]
        return [package for text in texts for package in parse_lock(text)]
    except (OSError, ValueError) as problem:
        raise GradingError(
            f"The lock in {root / LOCK} cannot be read: {problem}. `course-kit dev lock --upgrade` writes it anew."
        ) from problem


def make_bundle(root: Path, asked: Sequence[str] | None, known: Sequence[str], folder: Path, *, tests: bool) -> None:
    """Download what the Pythons need that are asked for, `all` or else this one, and say how much it is."""
    wanted = list(dict.fromkeys(asked or [".".join(platform.python_version_tuple()[:2])]))
    wanted = list(known) if "all" in wanted else wanted
    if unknown := [version for version in wanted if version not in known]:
        raise GradingError(f"the course is for Python {', '.join(known)}, not {', '.join(unknown)}.")
    folder.mkdir(parents=True, exist_ok=True)
    for python in wanted:
        found = locked_packages(root, python, tests=tests)
        print(f"course: {len(found)} packages for Python {python}", flush=True)
        download_packages(found, python, folder)
    size = sum(path.stat().st_size for path in folder.glob("*.whl")) // _MB
    print(
        f"course: {size} MB in {folder}. Take it to the classroom with the course's folder; there run: "
        "./course lab --find-links DIR"
    )


def locked_packages(root: Path, python: str, *, tests: bool = False) -> list[LockedPackage]:
    """What a set-up on a Python such as "3.12" installs where no ROS 2 is sourced."""
    found = read_lock(root, [*_PARTS, *(_TEST_PARTS if tests else ())])
    return list(dict.fromkeys(package for package in found if package.is_for(python)))


def download_packages(wanted: Sequence[LockedPackage], python: str, folder: Path) -> None:
    """Download the files of packages into a folder; files that exist are not downloaded again."""
    for batch in _batches(wanted):
        _download(batch, python, folder)


def _batches(wanted: Sequence[LockedPackage]) -> Iterator[list[LockedPackage]]:
    """Lists in which no package has two versions, as 3.11.4 and 3.11.5 may need: pip would refuse that."""
    left = list(wanted)
    while left:
        batch = list({package.name: package for package in left}.values())
        yield batch
        left = [package for package in left if package not in batch]


def _download(wanted: Sequence[LockedPackage], python: str, folder: Path) -> None:
    with tempfile.TemporaryDirectory() as work:
        requirements = Path(work, "requirements.txt")
        requirements.write_text("".join(f"{package.line(with_marker=False)}\n" for package in wanted), encoding="utf-8")
        command = [
            *(sys.executable, "-c", _PIP, "download", "--disable-pip-version-check", "--quiet"),
            *("--no-deps", "--require-hashes", "--requirement", str(requirements)),
            *("--dest", str(folder), "--find-links", str(folder)),
            *("--only-binary=:all:", f"--no-binary={_ONLY_AS_SOURCE}", "--ignore-requires-python"),
            *_kind_of_wheels(python),
        ]
        try:
            code = subprocess.run(command, stdout=sys.stderr, timeout=_DEADLINE_S, check=False).returncode
        except (OSError, subprocess.TimeoutExpired) as problem:
            raise GradingError(f"pip did not finish: {problem}") from problem
    if code:
        raise GradingError(
            f"The download for Python {python} did not finish; the lines above say why. It needs a network connection. "
            "Then run the same command again: what is in the folder stays."
        )


def _kind_of_wheels(python: str) -> list[str]:
    """Options by which pip takes the wheels that work on every Linux the course is for, not on this one alone."""
    version = tuple(map(int, python.split(".")))
    legacy = [f"manylinux{name}_x86_64" for name in ("2014", "2010", "1")]
    platforms = [*(f"manylinux_2_{minor}_x86_64" for minor in _GLIBC), *legacy, "linux_x86_64"]
    abis = dict.fromkeys(tag.abi for tag in cpython_tags(version, platforms=["any"]))
    return [
        *("--implementation", "cp", "--python-version", python),
        *(f"--platform={tag}" for tag in platforms),
        *(f"--abi={abi}" for abi in abis),
    ]

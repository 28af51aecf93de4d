"""`course-kit dev lock`: resolves what the course needs, for every Python it is for, and writes it down with hashes.

Everything is resolved at once, so that no package has two versions; then each file of the lock takes its part. uv
does both, because it resolves for all Pythons at once.
"""

from __future__ import annotations

import argparse
import itertools
import subprocess
import tempfile
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from course_kit import environment
from course_kit.authoring import wheel_bundle
from course_kit.dev import suite
from course_kit.grading.errors import GradingError
from course_kit.text.console import refuse

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.authoring.wheel_bundle import LockedPackage

PYTHONS = ("3.10", "3.11", "3.12", "3.13", "3.14")  # that the course is for
EXTRAS = ("ros", "test-ros", "test")
# Beside pyproject.toml's: hatchling asks for `editables`, hatch_build.py for `ziglang` where there is no C compiler;
# `empy`, which ROS needs, comes as source, for which pip takes setuptools and older ones `wheel`.
_BUILD_TOOLS = ("editables>=0.3", "ziglang>=0.13", "setuptools>=70.1", "wheel>=0.45")
_PIP = "pip>=25.3"
_UV = "uv>=0.9"
_NUMPY_1 = ("numpy>=1.26,<2; python_version < '3.13'", "numpy>=1.26; python_version >= '3.13'")
# Of what the course does not ask for itself. From jsonschema 4.25 on, each import of nbformat and each start of
# JupyterLab compiles a grammar for a second (rfc3987-syntax 1.1.0). Not in [tool.uv], which holds for set-ups, too.
_CONSTRAINTS = ("jsonschema<4.25",)
_HEADERS = {
    "uv": "the uv that installs the rest, where a machine has none",
    "pip": "the pip of the environment, for the user",
    "course": "what the course always needs, but numpy",
    "numpy": "numpy, but beside a sourced ROS 2 that brings none or a very old one",
    "numpy-1": "numpy for a sourced ROS 2 that brings none or a very old one: its messages are compiled for numpy 1",
    "ros": "ROS 2 Jazzy, where none is sourced",
    "test-ros": "what the tests need beside these wheels of ROS 2",
    "test": "what the tests need",
    "build": "what builds the course's own package, and the packages that come as source",
}
_SYSTEMS = ("Linux", "Darwin")  # a Mac with a ROS 2 of RoboStack's
_DEADLINE_S = 600.0


def main(arguments: Sequence[str]) -> int:
    """Write the lock anew; 0 when that went well, else 2."""
    parser = argparse.ArgumentParser(
        prog=f"{environment.course_command()} dev lock",
        description="Write the versions and hashes of all packages that a set-up installs to course_setup/locked. "
        "Versions that are there and still fit stay.",
    )
    parser.add_argument("--upgrade", action="store_true", help="take the newest version of each package that fits")
    options = parser.parse_args(arguments)
    root = environment.checkout_folder()
    uv = suite.find_uv()
    if root is None:
        return refuse("the lock belongs to the course's folder; run this in a clone of it.")
    if uv is None:
        return refuse("there is no uv, which resolves for all Pythons at once. `./course test` installs it.")
    there = [name for name in _HEADERS if name != "numpy-1" and (root / wheel_bundle.LOCK / f"{name}.txt").exists()]
    before = [] if options.upgrade else wheel_bundle.read_lock(root, there)
    for name, packages in resolve_lock(root, uv, before).items():
        environment.write_atomically(root / wheel_bundle.LOCK / f"{name}.txt", text_of(name, packages), durable=False)
    print(f"course: the lock is in {wheel_bundle.LOCK}. See git diff, then run ./course test.")
    return 0


def resolve_lock(root: Path, uv: str, before: Sequence[LockedPackage]) -> dict[str, list[LockedPackage]]:
    """The packages of each file of the lock; the versions of those `before` stay where they fit."""
    project = msgspec.toml.decode((root / "pyproject.toml").read_bytes())
    build = [*project["build-system"]["requires"], *_BUILD_TOOLS]
    compiled = partial(_compile, root, uv)
    everything = compiled(EXTRAS, [*build, _UV, _PIP], prefer=before)
    course = compiled((), [], within=everything)
    extras = {extra: _subtract_packages(course, compiled((extra,), [], within=everything)) for extra in EXTRAS}
    return {
        "uv": compiled(None, [_UV], within=everything),
        "pip": compiled(None, [_PIP], within=everything),
        "course": [package for package in course if package.name != "numpy"],
        "numpy": [package for package in course if package.name == "numpy"],
        "numpy-1": compiled(None, _NUMPY_1),
        **extras,
        "test-ros": _subtract_packages(extras["ros"], extras["test-ros"]),
        "build": compiled(None, build, within=everything),
    }


def text_of(name: str, packages: Sequence[LockedPackage]) -> str:
    """A file of the lock."""
    header = f"# {_HEADERS[name][0].upper()}{_HEADERS[name][1:]}. `course-kit dev lock` writes this file.\n"
    return header + "".join(f"{package.line()}\n" for package in packages)


def _compile(  # noqa: PLR0913 - what uv is asked
    root: Path,
    uv: str,
    extras: Sequence[str] | None,
    requirements: Sequence[str],
    *,
    prefer: Sequence[LockedPackage] = (),
    within: Sequence[LockedPackage] = (),
) -> list[LockedPackage]:
    """The packages that are needed for some extras of pyproject.toml (None: not even for the course) and more."""
    with tempfile.TemporaryDirectory() as folder:
        more, known, target = (Path(folder, name) for name in ("more.in", "known.txt", "resolved.txt"))
        more.write_text("\n".join(requirements))
        known.write_text("\n".join([*_CONSTRAINTS, *(package.line() for package in within)]))
        target.write_text("\n".join(package.line() for package in prefer))
        wanted = [] if extras is None else ["pyproject.toml", *(f"--extra={extra}" for extra in extras)]
        command = [
            *(uv, "pip", "compile", "--quiet", "--universal", "--generate-hashes", "--no-header", "--no-annotate"),
            *("--no-emit-index-url", "--no-emit-find-links"),  # neither is the same for everybody
            *("--python-version", PYTHONS[0], "--constraints", str(known), "--output-file", str(target)),
            *(*wanted, str(more)),
        ]
        try:
            done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=_DEADLINE_S, check=False)
        except (OSError, subprocess.TimeoutExpired) as problem:
            raise GradingError(f"uv did not finish: {problem}") from problem
        if done.returncode:
            raise GradingError(f"uv could not resolve what the course needs:\n{done.stderr.strip()}")
        return [package for package in wheel_bundle.parse_lock(target.read_text(encoding="utf-8")) if _places(package)]


def _subtract_packages(base: Sequence[LockedPackage], packages: Sequence[LockedPackage]) -> list[LockedPackage]:
    """Those that `base` does not install; its markers may say the same in other words."""
    known = {(locked.name, locked.version, place) for locked in base for place in _places(locked)}
    return [
        locked for locked in packages if {(locked.name, locked.version, place) for place in _places(locked)} - known
    ]


def _places(package: LockedPackage) -> list[tuple[str, str]]:
    """The Pythons and systems on which a package is installed, of those that the course is for."""
    return [place for place in itertools.product(PYTHONS, _SYSTEMS) if package.is_for(*place)]

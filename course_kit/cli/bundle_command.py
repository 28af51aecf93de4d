"""`course-kit bundle`: downloads what a set-up needs, for classrooms without a network."""

from __future__ import annotations

import platform
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit import environment
from course_kit.text.console import cannot

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

_MB = 2**20


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser(
        "bundle",
        help="download every package a set-up needs, for classrooms without a network",
        description="Download the packages of the lock into DIR. `./course lab --find-links DIR` then sets the course "
        "up without a network, on any x86-64 Linux.",
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="made if it is missing; what is there stays")
    parser.add_argument(
        "--python",
        action="append",
        metavar="VERSION",
        help="the Python of the classroom, such as 3.12, or `all`; repeatable; this one if left out",
    )
    parser.add_argument("--test", action="store_true", help="what ./course test needs, too")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Download; returns 0, or 2 when that could not be done."""
    from course_kit.authoring import wheel_bundle

    root = environment.checkout()
    if root is None:
        return cannot("the list of packages belongs to the course's folder; run this in a clone of it.")
    wanted = _pythons(options.python)
    if unknown := [version for version in wanted if version not in _known()]:
        return cannot(f"the course is for Python {', '.join(_known())}, not {', '.join(unknown)}.")
    folder = options.folder.absolute()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for python in wanted:
            packages = wheel_bundle.packages(root, python, tests=options.test)
            print(f"course: {len(packages)} packages for Python {python}", flush=True)
            wheel_bundle.download(packages, python, folder)
        size = sum(path.stat().st_size for path in folder.glob("*.whl")) // _MB
    except wheel_bundle.BundleError as problem:
        return cannot(problem)
    except OSError as problem:
        return cannot(f"{folder} could not be written: {problem.strerror}.")
    print(
        f"course: {size} MB in {folder}. Take it to the classroom with the course's folder; there run: "
        "./course lab --find-links DIR"
    )
    return 0


def _pythons(asked: Sequence[str] | None) -> list[str]:
    if asked and "all" in asked:
        return _known()
    return list(dict.fromkeys(asked or [".".join(platform.python_version_tuple()[:2])]))


def _known() -> list[str]:
    from course_kit.dev import pythons

    return pythons.wanted()

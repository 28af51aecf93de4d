"""`course-kit lab`, `copy` and `update`: the learner's folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import argparse


def add_to(verbs: Any) -> None:
    """Add the verbs to the command line's parser."""
    lab = verbs.add_parser(
        "lab",
        help="open the course in JupyterLab",
        usage="course-kit lab [DIR] [OPTIONS]",
        description="DIR is your folder, made or brought up to date. Left out, it is the one you are in, else "
        "my-course in a clone of the course, else ros2-course in your home directory.",
        epilog="OPTIONS go to `jupyter lab`.",
    )
    lab.set_defaults(run=_lab, others=[])

    copy = verbs.add_parser("copy", help="make your folder of lessons and exercises, or complete it")
    copy.add_argument("path", nargs="?", type=Path, help="the folder; if left out, the one that `lab` opens")
    copy.set_defaults(run=_copy)

    update = verbs.add_parser(
        "update",
        help="bring your folder up to date with the course; what you have changed stays",
        description="New versions of what you have not changed replace the old ones. A new version of what you have "
        "changed is laid beside yours.",
    )
    update.add_argument("path", nargs="?", type=Path, help="your folder; if left out, the one that `lab` opens")
    update.set_defaults(run=_update)


def _lab(options: argparse.Namespace) -> int:
    from course_kit.integrations import jupyter

    return jupyter.run_lab(options.others)


def _copy(options: argparse.Namespace) -> int:
    from course_kit.learner import workspace

    return workspace.copy(options.path)


def _update(options: argparse.Namespace) -> int:
    from course_kit.learner import workspace

    return workspace.copy(options.path, restore=False)

"""The commands of those who teach with the course, or work on it: a student edition comes without them."""

from __future__ import annotations

import argparse

from course_kit.cli import (
    bundle_command,
    class_command,
    export_command,
    new_command,
    present,
    prove_command,
    release_command,
    seeds_command,
)
from course_kit.integrations import otter

_TOOLS = ("check", "container", "hub", "lock", "matrix", "notebooks", "otter", "site")


def add_to(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add them to the command line's parser."""
    release_command.add_to(verbs)
    class_command.add_to(verbs)
    seeds_command.add_to(verbs)
    export_command.add_to(verbs)
    prove_command.add_to(verbs)
    otter.add_to(verbs)
    new_command.add_to(verbs)
    bundle_command.add_to(verbs)
    present.add_to(verbs)

    dev = verbs.add_parser("dev", help="for those who work on the course: prove that its graders are right")
    dev.add_argument("tool", choices=_TOOLS)
    dev.add_argument("rest", nargs=argparse.REMAINDER, help="its options; see course-kit dev TOOL --help")
    dev.set_defaults(run=_dev)


def _dev(options: argparse.Namespace) -> int:
    from course_kit.authoring import check
    from course_kit.dev import container_image, hub, lock, matrix, notebooks, otter
    from course_kit.dev.site import command as site

    mains = (check.main, container_image.main, hub.main, lock.main, matrix.main, notebooks.main, otter.main, site.main)
    return dict(zip(_TOOLS, mains, strict=True))[options.tool](options.rest)

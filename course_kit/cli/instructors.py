"""The commands of those who teach with the course, or work on it: a student edition comes without them."""

from __future__ import annotations

import argparse

from course_kit.cli import (
    class_command,
    export_command,
    new_command,
    present,
    prove_command,
    regrade_command,
    release_command,
    seeds_command,
)
from course_kit.integrations import otter


def add_to(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add them to the command line's parser."""
    release_command.add_to(verbs)
    class_command.add_to(verbs)
    regrade_command.add_to(verbs)
    seeds_command.add_to(verbs)
    export_command.add_to(verbs)
    prove_command.add_to(verbs)
    otter.add_to(verbs)
    new_command.add_to(verbs)

    present.add_to(verbs)

    dev = verbs.add_parser("dev", help="for those who work on the course: prove that its graders are right")
    dev.add_argument("tool", choices=("check", "hub", "matrix", "notebooks", "otter"))
    dev.add_argument("rest", nargs=argparse.REMAINDER, help="its options; see course-kit dev TOOL --help")
    dev.set_defaults(run=_dev)


def _dev(options: argparse.Namespace) -> int:
    from course_kit.authoring import check
    from course_kit.dev import hub, matrix, notebooks, otter

    main_of = {
        "check": check.main,
        "hub": hub.main,
        "matrix": matrix.main,
        "notebooks": notebooks.main,
        "otter": otter.main,
    }
    return main_of[options.tool](options.rest)

"""`course-kit release`: makes the student edition."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import argparse


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    release = verbs.add_parser(
        "release",
        help="make the student edition: the course without its answers",
        epilog="Every program in it is graded, so it takes a minute or two. Exit code: 0 when it was made, 1 when a "
        "program in it scores more than its exercise's starter, 2 when it could not be made.",
    )
    release.add_argument("target", help="a new folder, or a file that ends in .zip")
    release.add_argument(
        "--without", action="append", default=[], metavar="EXERCISE", help="leave this exercise out; repeatable"
    )
    release.add_argument("--left-out", metavar="FILE", help="write the name of every file that is left out to FILE")
    release.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> int:
    from course_kit.authoring import release

    return release.run(options.target, options.without, options.left_out)

"""The options that say how much of a message is shown, and in which form."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.ros2cli.text import TRUNCATE, Layout

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace


def add_layout(verb: ArgumentParser) -> None:
    """The options of every verb that shows messages."""
    verb.add_argument("-f", "--full-length", action="store_true", help="long strings and arrays in full")
    verb.add_argument("-l", "--truncate-length", type=int, default=TRUNCATE, metavar="N", help="where they are cut")
    verb.add_argument("--no-arr", action="store_true", help="no elements of arrays")
    verb.add_argument("--no-str", action="store_true", help="no strings")
    verb.add_argument("--flow-style", action="store_true", help="in one line")
    verb.add_argument("--csv", action="store_true", help="values separated by commas")


def layout_of(options: Namespace) -> Layout:
    """How much those options ask for."""
    return Layout(
        truncate=None if options.full_length else options.truncate_length,
        arrays=not options.no_arr,
        strings=not options.no_str,
        flow=options.flow_style,
    )

"""Parsers of commands, whole, for the pages that describe them."""

from __future__ import annotations

from course_kit.ros2cli import parser


def ros2() -> parser.Parser:
    """The parser of `ros2` with the verbs of all commands; a command line that is run has only those it needs."""
    return parser.build(list(parser.COMMANDS))

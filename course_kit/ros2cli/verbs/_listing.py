"""What the `list` verbs share."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from course_kit.ros.names import from_root
from course_kit.ros2cli.errors import CommandError
from course_kit.ros2cli.graph_source import graph_for

if TYPE_CHECKING:
    from course_kit.ros2cli.graph import Graph, Names
    from course_kit.ros2cli.session import Session

_NAME = re.compile(r"(?:/?(?:[A-Za-z_~]\w*)(?:/[A-Za-z_]\w*)*|/)")


def graph_of(options: Any, session: Session) -> Graph:
    """The graph as the options ask for it."""
    return graph_for(session, options.timeout, daemon=not options.no_daemon)


def print_names(names: Names, *, types: bool, count: bool) -> None:
    """One name a line, with its types in brackets when asked for; or only how many there are.

    Args:
        names: the names, each with its types.
        types: whether these are shown.
        count: whether only their number is shown.
    """
    if count:
        print(len(names))
        return
    for name, its_types in names.items():
        print(f"{name} [{', '.join(its_types)}]" if types else name)


def checked_name(name: str) -> str:
    """A graph name from the root.

    Raises:
        CommandError: it cannot be one ("Topic and service names" in the ROS 2 design articles).
    """
    if not _NAME.fullmatch(name):
        raise CommandError(
            f"{name!r} cannot be a name on the graph: parts begin with a letter, followed by letters, digits and _, "
            "with / between."
        )
    return from_root(name)

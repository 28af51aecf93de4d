"""`%ros2`: the command inside the kernel, in the context of its nodes, so nothing has to be discovered."""

from __future__ import annotations

import shlex
import sys

from course_kit.ros2cli.cli import run


def ros2_line(line: str) -> None:
    """Run `%ros2 service list` and the like in this kernel; what it prints belongs to the cell."""
    from course_kit import lab

    try:
        words = shlex.split(line)
    except ValueError as error:
        sys.stderr.write(f"%ros2 {line}: {error}.\n")
        return
    engine = lab.current().engine
    run(words, engine.node.context, engine.guests)

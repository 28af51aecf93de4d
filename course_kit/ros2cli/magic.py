"""`%ros2`: the command inside the kernel, in the context of its nodes, so nothing has to be discovered."""

from __future__ import annotations

import shlex
import sys

from course_kit.ros2cli.cli import run


def ros2_line(line: str) -> None:
    """Run `%ros2 service list` and the like in this kernel; what it prints belongs to the cell.

    Verbs that ask nodes do so from the context of `course_kit.lab`; `run` and `launch` start a process as in a
    terminal, and interrupting the cell ends it. Errors are one line in the cell, no traceback.

    Args:
        line: what stands behind `%ros2`.
    """
    from course_kit import lab

    try:
        words = shlex.split(line)
    except ValueError as error:
        sys.stderr.write(f"%ros2 {line}: {error}.\n")
        return
    engine = lab.current().engine
    run(words, engine.node.context, engine.guests)

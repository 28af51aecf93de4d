"""Runs a program from within a kernel and shows what it prints in the cell."""

from __future__ import annotations

import sys

from course_kit import environment
from course_kit.process.child import INTO_STDOUT, PIPE, Child, Ladder

_GRACE_S = 10.0  # to end in after a Ctrl-C; `ros2 launch` itself needs some to end its children
_MORE_S = 5.0


def run_and_show(command: list[str]) -> int:
    """Run `command` until it ends; an interrupt of the cell is passed on. The exit code."""
    environ = environment.child_environment(PYTHONUNBUFFERED="1", PYTHON_COLORS="0")
    child = Child(command, environ=environ, stdout=PIPE, stderr=INTO_STDOUT)
    try:
        for line in child.stdout or ():
            sys.stdout.write(line.decode(errors="replace"))
        child.wait()
    except KeyboardInterrupt:
        sys.stdout.write(child.end(Ladder(_GRACE_S, _MORE_S, _MORE_S)).decode(errors="replace"))
    finally:
        code = child.kill()
    return code

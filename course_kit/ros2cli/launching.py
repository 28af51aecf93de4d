"""Runs the launch file of a `%%ros_launch` cell as a child of the kernel.

`python -m course_kit.ros2cli.launching NAME PARENT_PID DESCRIPTOR FILE [name:=value ...]`. The processes are those
`ros2 launch` would start. They write into the notebook directly, and report like scripts what crosses.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.launch.actions import not_an_argument
from course_kit.launch.errors import LaunchError
from course_kit.launch.service import LaunchedProcess, LaunchService
from course_kit.process.child import INTO_STDOUT, PIPE, Child, Ladder
from course_kit.process.libc import die_with_parent

if TYPE_CHECKING:
    from course_kit.launch.node import ProcessDescription

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


MODULE = __name__
_RUNNER = ("-m", "course_kit.lab.scripts.child_main")


class NotebookLaunch(LaunchService):
    """One run of a launch file in a notebook."""

    def __init__(self, script: str, descriptor: int) -> None:
        super().__init__(Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115 - it lives as long as this
        self._script, self._descriptor = script, descriptor

    def make_child(self, description: ProcessDescription, label: str) -> LaunchedProcess:
        """Start a process that writes into the notebook; a Python program under the runner of scripts."""
        command = description.command
        words = list(command)
        if command[0] == sys.executable and command[1].endswith(".py"):
            words[1] = Path(command[1]).name
            around = [sys.executable, *_RUNNER, self._script, str(os.getpid()), str(self._descriptor)]
            command = [*around, *command[1:]]
        log_format = f"[{label}] [{{severity}}] [{{name}}]: {{message}}"
        look = {"RCUTILS_CONSOLE_OUTPUT_FORMAT": log_format, "RCUTILS_COLORIZED_OUTPUT": "0"}
        child = LaunchedProcess(
            description,
            label,
            command=command,
            environ={**description.environ, **look},
            inherits=(self._descriptor,),
        )
        child.command = " ".join(["python", *words[1:2]])
        return child

    def say(self, text: str, *, shown: bool = True) -> None:
        """Write a line; how the processes are stopped, one after the other, is no news when the learner does it."""
        super().say(text, shown=shown and not self.stopping)

    def _take_signals(self, numbers: bytes) -> None:
        self.stopping |= any(number in numbers for number in (signal.SIGINT, signal.SIGTERM))
        super()._take_signals(numbers)


def main() -> int:
    """Become the launch of the file given on the command line."""
    name, parent, descriptor, path, *arguments = sys.argv[1:]
    die_with_parent(int(parent), signal.SIGTERM)
    values: dict[str, str] = {}
    for argument in arguments:
        key, separator, value = argument.partition(":=")
        if not separator:
            sys.stderr.write(f"{not_an_argument(argument)}\n")
            return 1
        values[key] = value
    try:
        return NotebookLaunch(name, int(descriptor)).run(Path(path), values)
    except (LaunchError, environment.DomainError) as error:
        sys.stderr.write(f"{error}\n".replace(f"{Path(path).parent}{os.sep}", ""))
        return 1


if __name__ == "__main__":
    sys.exit(main())

"""The magics of the course: each parses its line, calls one function, and shows what came of it."""

from __future__ import annotations

import shlex
import sys
from typing import TYPE_CHECKING

from IPython.core.getipython import get_ipython

from course_kit import environment
from course_kit.grading.errors import GradingError
from course_kit.integrations.grade_magics import GradeMagics, complains, print_complaint, the_exercises
from course_kit.lab.errors import LabError

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

    from course_kit.learner.step_check import StepResult

_SCRIPT_USAGE = (
    "Write %%ros_script NAME [arguments] in the first line and the program below it, "
    "such as: %%ros_script client 1 2. Options before the name: --wait, --background."
)
_INTERFACE_USAGE = (
    "Write %%interface PACKAGE/srv/NAME (or msg, or action) in the first line and the definition below it, "
    "such as: %%interface my_interfaces/srv/PersonInfo."
)
_LAUNCH_USAGE = (
    "Write %%ros_launch NAME [argument:=value] in the first line and the launch file below it, "
    "such as: %%ros_launch robot."
)
_HINT_USAGE = "Use it as %hint EXERCISE. --again repeats those you have already seen."
_MODES = {"--wait": "wait", "--background": "background"}


class MagicError(LabError):
    """A magic was used in a way it cannot be; the message says how it is used."""


def register_magics(shell: InteractiveShell) -> None:
    """Make the magics known to an IPython shell."""
    from course_kit.ros2cli.cli import ros2_line

    shell.register_magics(GradeMagics)
    shell.register_magic_function(interface, "cell", "interface")
    shell.register_magic_function(ros_script, "line_cell", "ros_script")
    shell.register_magic_function(ros_launch, "line_cell", "ros_launch")
    shell.register_magic_function(ros_stop, "line", "ros_stop")
    shell.register_magic_function(check_line, "line", "check")
    shell.register_magic_function(hint_line, "line", "hint")
    shell.register_magic_function(ros2_line, "line", "ros2")


def interface(line: str, cell: str) -> None:
    """Define a ROS interface: `%%interface my_interfaces/srv/PersonInfo`, its text in the cell."""
    __tracebackhide__ = True
    from course_kit import interfaces

    words = line.split()
    if len(words) != 1:
        raise MagicError(_INTERFACE_USAGE)
    try:
        defined = interfaces.define(words[0], cell)
    except (ValueError, LookupError) as error:
        raise MagicError(str(error)) from None
    package, kind, name = words[0].split("/")
    get_ipython().user_ns[name] = defined  # a name imported before would go on meaning the old one
    print(f"{words[0]} is defined. In programs: from {package}.{kind} import {name}")


def ros_script(line: str, cell: str | None = None) -> None:
    """Run the cell as an unmodified ROS 2 program: `%%ros_script client 1 2`."""
    __tracebackhide__ = True
    from course_kit import lab

    try:
        words = shlex.split(line)
    except ValueError as error:
        raise MagicError(f"A quote in the line is not closed ({error}). {_SCRIPT_USAGE}") from None
    mode = "auto"
    while words and words[0].startswith("-"):
        if words[0] not in _MODES:
            raise MagicError(f"There is no option {words[0]}. {_SCRIPT_USAGE}")
        mode = _MODES[words.pop(0)]
    if not words:
        raise MagicError(_SCRIPT_USAGE)
    lab.script(words[0], _find_saved(words[0]) if cell is None else cell, *words[1:], mode=mode)


def _find_saved(name: str) -> str:
    """The program that the first line of a cell has saved under a name."""
    path = environment.run_dir(environment.paths.CELL_PROGRAMS) / f"{name.removesuffix('.py')}.py"
    if not path.is_file():
        known = ", ".join(sorted(file.stem for file in path.parent.glob("*.py"))) or "none"
        raise MagicError(f"No program is saved as {name!r}: run its cell first. Saved: {known}.")
    return path.read_text(encoding="utf-8")


def ros_launch(line: str, cell: str | None = None) -> None:
    """Run the cell as a launch file: `%%ros_launch robot speed:=2.0`, as `ros2 launch robot.launch.py speed:=2.0`.

    `%ros_launch robot` runs the one that was saved under this name.
    """
    __tracebackhide__ = True
    from course_kit import lab
    from course_kit.ros2cli import launching

    words = shlex.split(line)
    if not words or words[0].startswith("-"):
        raise MagicError(_LAUNCH_USAGE)
    name = f"{words[0].removesuffix('.py').removesuffix('.launch')}.launch"
    lab.current().scripts.run(
        name, _find_saved(name) if cell is None else cell, tuple(words[1:]), "background", launching.MODULE
    )


def ros_stop(line: str) -> None:
    """Stop a script: `%ros_stop server`; `--ctrl-c` shows how it ends in a terminal; without a name, all of them."""
    __tracebackhide__ = True
    from course_kit import lab

    words = line.split()
    names = [word for word in words if word != "--ctrl-c"]
    if len(names) > 1:
        raise MagicError("Write %ros_stop NAME, or %ros_stop alone to stop all scripts.")
    lab.current().scripts.stop(names[0] if names else None, as_in_terminal="--ctrl-c" in words)


@complains
def hint_line(line: str) -> None:
    """Show one more hint for what failed last: `%hint EXERCISE`; `--again` repeats those given so far."""
    from course_kit.learner import hints

    words = line.split()
    again = "--again" in words
    names = [word for word in words if word != "--again"]
    if len(names) != 1 or names[0].startswith("-"):
        raise GradingError(f"{_HINT_USAGE} {the_exercises()}")
    text, trouble = hints.next_hint(names[0], "%hint", again=again)
    sys.stdout.write(text)
    if trouble:
        print_complaint(trouble)


def check_line(line: str) -> StepResult:
    """Ask your running nodes about a step of the lesson: `%check subtract`."""
    __tracebackhide__ = True
    from course_kit.integrations.at_start import RUN_AGAIN, is_new
    from course_kit.learner.step_check import StepResult, check_step
    from course_kit.learner.steps import STEPS
    from course_kit.ros.names import did_you_mean

    name = line.strip()
    if name not in STEPS:
        raise MagicError(f"There is no step {name!r}.{did_you_mean(name, STEPS)} Use it as %check STEP.")
    if is_new():
        return StepResult(passed=False, text=f"The kernel has just been started and runs no node yet: {RUN_AGAIN}")
    return check_step(STEPS[name])

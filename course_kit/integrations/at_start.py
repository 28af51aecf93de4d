"""What every kernel of the course's environment has from its start: magics that load the course when they are used.

After a restart a learner runs the cell they were at, such as `%grade`, and nothing is loaded: the magic loads the
course then, and so does a pasted program that spins. As for `lab` and what cells define, a sentence says what to run.
"""

from __future__ import annotations

import sys
from contextlib import suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from IPython.core.interactiveshell import ExecutionInfo, ExecutionResult, InteractiveShell

_ROS_MAGICS = ("interface", "ros2", "ros_launch", "ros_script", "ros_stop")
_MAGICS = ("check", "grade", "hint", "solution", "submission", *_ROS_MAGICS)
_NAMES = ("lab", "panels")
RUN_AGAIN = "run the notebook's first code cell, then the cells down to this one (Run > Run All Above Selected Cell)."


class _Kernel:
    is_new = False


def is_new() -> bool:
    """Whether the notebook's first code cell has not run since the kernel started."""
    return _Kernel.is_new


def load_ipython_extension(shell: InteractiveShell) -> None:
    """Called when a kernel starts."""
    shell.magics_manager.lazy_magics.update(dict.fromkeys(_MAGICS, "course_kit"))
    _Kernel.is_new = True

    def before_cell(info: ExecutionInfo) -> None:
        from course_kit.environment import DomainError

        if "load_ext course_kit" in info.raw_cell:
            _Kernel.is_new = False
        if "rclpy.spin(" in info.raw_cell and not info.raw_cell.startswith(("%%", "# %%")):
            with suppress(DomainError):  # what the cell itself asks of ROS says so
                shell.extension_manager.load_extension("course_kit")
                from course_kit import lab

                lab.current().engine  # noqa: B018 - from now on rclpy.init and rclpy.spin say what they do in a cell

    def after_cell(result: ExecutionResult) -> None:
        error = result.error_in_exec
        if not isinstance(error, NameError) or not error.name or not is_new():
            return
        from course_kit.environment.notebook import defining_line

        if error.name in _NAMES or defining_line(error.name, result.info.raw_cell):
            sys.stderr.write(f"The kernel has just been started and does not know {error.name} yet: {RUN_AGAIN}\n")

    shell.events.register("pre_run_cell", before_cell)
    shell.events.register("post_run_cell", after_cell)

"""Runs at the start of every Python of this environment, through `course_kit.pth`; so it does next to nothing.

It makes the course's interfaces importable in any program. When rclpy is first imported it has the ROS settings of the
course made, so that a plain `python server.py` in a terminal joins the same graph as the notebook, and a fault of the
wheels repaired.
`COURSE_KIT_AUTOLOAD=0` turns it off. Even `typing` and `importlib.abc` would cost more than all of this.
"""

from __future__ import annotations

import os
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType


class _BeforeRclpy:
    """A meta path finder that finds nothing, and prepares the process when rclpy is about to be found."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        del path, target
        if fullname == "rclpy":
            sys.meta_path.remove(self)
            _make_settings()
            _repair_middleware()
        return None


def _make_settings() -> None:
    from course_kit import environment

    try:
        environment.apply()
    except environment.DomainError as problem:
        until_then = "" if "ROS_DOMAIN_ID" in os.environ else " Until then this program uses domain 0."
        print(f"course-kit: {problem}{until_then}", file=sys.stderr)


def _repair_middleware() -> None:
    try:
        from course_kit.environment import leaving
    except (ImportError, AttributeError):  # a Python built without libffi has no ctypes; a system without dlopen
        return
    leaving.repair()


def install() -> None:
    """Put the finders in place."""
    from course_kit.interfaces import finder
    from course_kit.launch import finder as launch_finder

    finder.install()
    launch_finder.install()
    sys.meta_path.insert(0, _BeforeRclpy())
    # Message classes read it when they are imported, which may be before rclpy is.
    os.environ.setdefault("ROS_PYTHON_CHECK_FIELDS", "1")


if os.environ.get("COURSE_KIT_AUTOLOAD") != "0":
    install()

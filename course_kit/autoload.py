"""Runs at the start of every Python of this environment, through `course_kit.pth`; so it does next to nothing.

It makes the course's interfaces importable in any program, and gives rclpy the course's settings when it is imported.
`COURSE_KIT_AUTOLOAD=0` turns it off. Even `typing` and `importlib.abc` would cost more than all of this.
"""

from __future__ import annotations

import os
import sys

_MIDDLEWARE = "librmw_fastrtps_shared_cpp.so"
_SET_LISTENER = "_ZN8eprosima7fastdds3dds17DomainParticipant12set_listenerEPNS1_25DomainParticipantListenerE"

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
            _repair_leaving()
            _make_settings()
        return None


def _make_settings() -> None:
    from course_kit import environment

    try:
        environment.apply_settings()
    except environment.DomainError as problem:
        until_then = "" if "ROS_DOMAIN_ID" in os.environ else " Until then this program uses domain 0."
        print(f"course-kit: {problem}{until_then}", file=sys.stderr)


def _repair_leaving() -> None:
    """Have the wheels' middleware find `leaving.c` first; an installed ROS 2 stays as it is."""
    helper = os.path.join(os.path.dirname(__file__), "interfaces", "native", "_helper.so")  # noqa: PTH118, PTH120
    if os.path.exists(os.path.join(sys.prefix, "lib", _MIDDLEWARE)):  # noqa: PTH110, PTH118 - without pathlib
        try:
            import ctypes

            if hasattr(ctypes.CDLL(helper), _SET_LISTENER):  # else it was compiled before there was one
                ctypes.CDLL(helper, ctypes.RTLD_GLOBAL)
        except (ImportError, OSError):  # a Python built without libffi; a helper that was not compiled
            return


def install() -> None:
    """Put the finders in place."""
    from course_kit.interfaces import finder
    from course_kit.launch import finder as launch_finder

    finder.install()
    launch_finder.install_finder()
    sys.meta_path.insert(0, _BeforeRclpy())
    # Message classes read it when they are imported, which may be before rclpy is.
    os.environ.setdefault("ROS_PYTHON_CHECK_FIELDS", "1")


if os.environ.get("COURSE_KIT_AUTOLOAD") != "0":
    install()

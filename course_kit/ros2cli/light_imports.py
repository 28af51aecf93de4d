"""Keeps a command from importing what it never uses."""

from __future__ import annotations

import sys
from types import ModuleType

_GENERATOR = "rosidl_generator_py.generate_py_impl"


def leave_out_the_generator() -> None:
    """Have rclpy's type support imported without the generator of message classes, which reads grammars at its import.

    `rosidl_generator_py` imports both, and does without the generator where that cannot be imported. Only for a
    process of the command's own, which generates nothing.
    """
    if _GENERATOR not in sys.modules:
        sys.modules[_GENERATOR] = ModuleType(_GENERATOR)  # without `generate_py`: an ImportError for those who ask

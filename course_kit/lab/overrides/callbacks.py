"""Callbacks that are none are told where they are given and not when they are used."""

from __future__ import annotations

import functools
import inspect
import re
from typing import TYPE_CHECKING, Any

from rclpy.action import ActionServer
from rclpy.node import Node

from course_kit import environment
from course_kit.lab.errors import CallbackError
from course_kit.lab.runtime.failures import is_own, own_line
from course_kit.ros.messages import with_article

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

    from course_kit.lab.overrides.patches import Patches
    from course_kit.lab.runtime.failures import Locate

# Where the callback stands among the arguments, after the node.
_CALLBACKS = {"create_service": 2, "create_subscription": 2, "create_timer": 1, "add_on_set_parameters_callback": 0}
_CALLED = re.compile(r"(?P<name>\w+(?:\.\w+)*)\(\)")
_EXECUTE = 3  # the place of an action server's execute callback, after the server: node, type, name, callback


def require_callables(patches: Patches, locate: Locate) -> None:
    """Replace rclpy's functions that are given callbacks; `patches` takes it back."""
    for method, place in _CALLBACKS.items():
        _require_callable(patches, Node, method, place, locate)
    _require_callable(patches, ActionServer, "__init__", _EXECUTE, locate, "execute_callback")


def _require_callable(  # noqa: PLR0913, PLR0917 - a method, where its callback is, and how cells are called
    patches: Patches, owner: Any, method: str, place: int, locate: Locate, option: str = "callback"
) -> None:
    original: Callable[..., Any] = getattr(owner, method)
    shown = "ActionServer" if method == "__init__" else method

    @functools.wraps(original)
    def checked(subject: Any, *arguments: Any, **options: Any) -> Any:
        __tracebackhide__ = True  # IPython: the learner's own lines are what matters
        if place < len(arguments) or option in options:
            given = arguments[place] if place < len(arguments) else options[option]
            caller = _caller()
            if not callable(given) and caller is not None and is_own(caller.f_code.co_filename):
                where, line = own_line(caller.f_code.co_filename, caller.f_lineno, locate)
                raise CallbackError(_no_function(shown, given, where, line))
        return original(subject, *arguments, **options)

    patches.set(owner, method, checked)


def _caller() -> FrameType | None:
    """Who has called, past the functions of the kit that stand in for rclpy's."""
    frame = inspect.currentframe()
    while frame is not None and frame.f_code.co_filename.startswith(str(environment.PACKAGE)):
        frame = frame.f_back
    return frame


def _no_function(method: str, given: object, where: str, line: str) -> str:
    what = "None" if given is None else with_article(type(given).__name__)
    called = _CALLED.search(line.partition("(")[2])
    meant = ""
    if called:
        meant = f" Without parentheses it is the function itself: write {called['name']}, not {called['name']}()."
    return f"{method}() was given {what} where it takes a function to call later ({where}: {line}).{meant}"

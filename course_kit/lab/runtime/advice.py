"""What an error of Python's or rclpy's means for a node, where its own words do not say it, and what to write."""

from __future__ import annotations

import linecache
import re
import traceback
from typing import TYPE_CHECKING, Any

from course_kit.lab.errors import error_text
from course_kit.ros import names

if TYPE_CHECKING:
    from types import CodeType

_ARGUMENTS = re.compile(r"(?P<name>\w+)\(\) takes (?P<takes>\d+) positional arguments? but (?P<given>\d+) ")
_SUB_MESSAGE = re.compile(r"The '(?P<field>\w+)' field must be a sub message of type '(?P<type>\w+)'")
_UNDECLARED = re.compile(r"undeclared parameter\(s\): (?P<name>\S+)")
_OF_EVERY_NODE = frozenset({"use_sim_time", "start_type_description_service"})
_GIVEN_TO = {  # what rclpy calls a callback with, by the class of what it belongs to
    "Service": ("request", "response"),
    "Subscription": ("message",),
    "Timer": (),
    "Turn": ("goal_handle",),
}


def advice_on(error: BaseException, node: Any = None, entity: Any = None) -> str:
    """A sentence or two; empty where there is nothing to add."""
    text = error_text(error)
    if newer := of_newer_ros(error):
        return newer
    node = node if node is not None else node_in(error)
    if isinstance(error, TypeError) and (found := _ARGUMENTS.search(text)):
        return _on_arguments(found["name"], node, entity)
    if isinstance(error, AssertionError) and (found := _SUB_MESSAGE.search(text)):
        return _on_sub_message(found["field"], found["type"])
    if isinstance(error, NameError) and callable(getattr(type(node), error.name or "", None)):
        return f"{error.name} belongs to the node. Write: self.{error.name}(...)"
    if type(error).__name__ == "ParameterNotDeclaredException" and (found := _UNDECLARED.search(text)):
        return _on_parameter(found["name"].strip("'[]"), node)
    return ""


def of_newer_ros(error: BaseException) -> str:
    """What to say of `with rclpy.init():`, which the examples of newer versions have; empty for any other error."""
    text = error_text(error)
    if not isinstance(error, (TypeError, AttributeError)) or not ("context manager" in text or "__enter__" in text):
        return ""
    lines = [
        linecache.getline(frame.f_code.co_filename, number) for frame, number in traceback.walk_tb(error.__traceback__)
    ]
    if not any("rclpy.init(" in line for line in lines[-1:]):
        return ""
    return (
        "This line belongs to a newer ROS 2. In Jazzy rclpy.init() returns nothing, so `with` cannot use it: write "
        "rclpy.init() on a line of its own, and rclpy.try_shutdown() where the block ends."
    )


def node_in(error: BaseException) -> Any:
    """The node whose method is the innermost in an error's traceback; None if there is none."""
    found = None
    for frame, _ in traceback.walk_tb(error.__traceback__):
        candidate = frame.f_locals.get("self")
        if hasattr(candidate, "get_fully_qualified_name"):
            found = candidate
    return found


def without_self(node_class: type, name: str) -> str:
    """What to say of a method whose first parameter is not self; empty where it is, or nothing is known of it."""
    code: CodeType | None = getattr(getattr(node_class, name, None), "__code__", None)
    if code is None:
        return ""
    parameters = code.co_varnames[: code.co_argcount]
    if parameters[:1] in {("self",), ("cls",)}:
        return ""
    return f"{name}() has no self. Write: def {name}({', '.join(('self', *parameters))}):"


def _on_arguments(name: str, node: Any, entity: Any) -> str:
    if node is None:
        return ""
    if missing := without_self(type(node), name):
        return missing
    given = _GIVEN_TO.get(type(entity).__name__)
    if given is None:
        return ""
    return f"rclpy calls it with {' and '.join(given) or 'nothing'}. Write: def {name}({', '.join(('self', *given))}):"


def _on_sub_message(field: str, kind: str) -> str:
    examples = {"Point": "x=1.0, y=2.0, z=0.0", "Vector3": "x=1.0, y=2.0, z=0.0", "Quaternion": "w=1.0"}
    example = f"{kind}({examples.get(kind, '...')})"
    return f"{field} is a message of its own. Write {example}, or set its fields one by one."


def _on_parameter(name: str, node: Any) -> str:
    if node is None:
        return ""
    declared = node.get_parameters_by_prefix("")  # works for a node that is destroyed, too, as its name does not
    own = [one for one in declared if one not in _OF_EVERY_NODE]
    if not own:
        return f"The node has declared no parameter so far: declare_parameter({name!r}, ...) comes first."
    return f"The node has declared {', '.join(own)}.{names.did_you_mean(name, own)}"

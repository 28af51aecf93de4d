"""Whether the private and version-bound names that the kit touches are there, and what is off where one is not.

Whoever uses such a name asks `Compatibility.has` first and does without: a missing name costs one feature and one
sentence. A name is `module:attribute.attribute`; the last may also be one that methods give to their objects.
"""

from __future__ import annotations

import pkgutil
import re
import sys
from contextlib import suppress
from types import FunctionType
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


class Feature(NamedTuple):
    """Something the kit does with names that a later version of ROS, IPython or nbval may not have."""

    lost: str
    names: tuple[str, ...]


def _dot(owner: str, *names: str) -> tuple[str, ...]:
    return tuple(owner + name for name in names)


_EXECUTOR = "rclpy.executors:Executor."
_SERVER = "rclpy.action.server:ActionServer."
_GOAL = "rclpy.action.server:ServerGoalHandle."
_CLIENT = "rclpy.action.client:ActionClient."
_C = "rclpy.impl.implementation_singleton:rclpy_implementation."
_LOG = "rcl_interfaces.msg:Log."  # any class that rosidl has generated; rclpy has always loaded this one

RECORDING = Feature(
    "lab.diagram() shows no services and topics, lab.timeline() no callbacks, a call learns of a failed callback only "
    "by its timeout, and lab.publish() does not wait for callbacks",
    (
        *_dot(_EXECUTOR, "_take_service", "_take_client", "_take_subscription", "_take_timer", "_is_shutdown"),
        *_dot("rclpy.client:Client.", "_lock", "_pending_requests", "logger_name"),
        *_dot("rclpy.subscription:Subscription.", "_callback_type", "logger_name"),
        "rclpy.publisher:Publisher.logger_name",
        "rclpy.service:Service.logger_name",
        "rclpy.task:Future._set_executor",
    ),
)
GOAL_RECORDING = Feature(
    "lab.diagram() shows no goals",
    (
        *_dot(_CLIENT, "_goal_sequence_number_to_goal_id", "_result_sequence_number_to_goal_id"),
        *_dot(_CLIENT, "_cancel_goal_async", "_pending_cancel_requests", "_node", "_action_name", "_action_type"),
        *_dot(_SERVER, "_execute_goal_request", "_execute_cancel_request", "_send_result_response", "_result_futures"),
        *_dot(_GOAL, "_update_state", "_action_server", "_goal_handle"),
        "rclpy.action.server:GoalEvent",
    ),
)
EXECUTIONS = Feature(
    "An execute callback keeps everything else in the lab waiting, and its errors are shown as rclpy shows them",
    _dot(_SERVER, "_execute_goal", "_node"),
)
FEEDBACK = Feature(
    "Feedback that comes faster than callbacks run may be shown late or not at all",
    _dot(_CLIENT, "_client_handle"),
)
WAITING_FOR_GOALS = Feature(
    "An answer to a goal may be missed when it comes at once",
    _dot(_CLIENT, "_cancel_goal_async", "_get_result_async"),
)
PENDING_CALLS = Feature(
    "An await that can never end hangs instead of saying why, and a call whose server is replaced meanwhile waits for "
    "its timeout",
    ("rclpy.client:Client._pending_requests",),
)
DEFAULT_CONTEXT = Feature(
    "After the lab of this process has ended, another one needs a restart",
    ("rclpy.utilities:g_default_context",),
)
LOG_LINES = Feature(
    "Log lines do not appear under the cells they belong to",
    ("rclpy.impl.rcutils_logger:_rclpy", _C + "rclpy_logging_rcutils_log"),
)
CELL_NAMES = Feature(
    "An error in a callback is shown without the number of its cell",
    ("IPython.core.compilerop:CachingCompiler.format_code_name",),
)
ERRORS = Feature("Some mistakes are shown in rclpy's words", _dot(_C, "RCLError"))
OWN_TYPES = Feature(
    "Message types of your own may not work",
    (
        *_dot(_LOG + "__class__.", "_CREATE_ROS_MESSAGE", "_CONVERT_FROM_PY", "_CONVERT_TO_PY", "_DESTROY_ROS_MESSAGE"),
        *_dot(_LOG + "__class__.", "_TYPE_SUPPORT", "__import_type_support__"),
        *_dot(_LOG, "_fields_and_field_types", "SLOT_TYPES"),
    ),
)
GRADING = Feature("Grading does not work", _dot(_C, "WaitSet", "GuardCondition"))
DIAGNOSES = Feature(
    "Reports do not say what a callback has returned instead of a response or a result, or whether it has ended the "
    "program",
    (
        "rclpy.service:Service.send_response.response",
        _SERVER + "_execute_goal.execute_result",
        "rclpy.executors:await_or_execute",
    ),
)

OF_SCRIPTS = (RECORDING, GOAL_RECORDING, EXECUTIONS)
_OF_CELLS = (PENDING_CALLS, DEFAULT_CONTEXT, LOG_LINES, CELL_NAMES, ERRORS, OWN_TYPES)
OF_THE_LAB = (*OF_SCRIPTS, FEEDBACK, WAITING_FOR_GOALS, *_OF_CELLS)
ALL = (*OF_THE_LAB, GRADING, DIAGNOSES)


class Compatibility(NamedTuple):
    """What was found in this process: the features of which names are missing, with these."""

    missing: Mapping[Feature, tuple[str, ...]]

    def has(self, feature: Feature) -> bool:
        """Whether a feature has all its names."""
        return feature not in self.missing

    def sentences(self) -> list[str]:
        """What is off and why, a sentence for each feature."""
        return [f"{feature.lost}: {_describe_absent(names)}." for feature, names in self.missing.items()]


def check_features(features: Iterable[Feature] = OF_THE_LAB) -> Compatibility:
    """Look for the names of these features, as far as their packages are loaded; those of others count as there."""
    missing = {feature: tuple(name for name in feature.names if not is_there(name)) for feature in features}
    return Compatibility({feature: names for feature, names in missing.items() if names})


def check_all() -> Compatibility:
    """Load the packages of the table, as far as they are installed, and look for every name."""
    for package in sorted({name.partition(".")[0] for feature in ALL for name in feature.names}):
        with suppress(ModuleNotFoundError):
            pkgutil.resolve_name(package)
    return check_features(ALL)


def is_there(name: str) -> bool:
    """Whether a name of the table can be used; one whose package is not loaded is in nobody's way."""
    if name.partition(".")[0] not in sys.modules:
        return True
    owner, last = re.split(r"[.:](?=\w+$)", name)
    try:
        found = pkgutil.resolve_name(owner)  # rclpy and IPython have loaded theirs: this only looks
    except (ImportError, AttributeError):
        return False
    return hasattr(found, last) or last in _names_in(found)


def _names_in(found: object) -> set[str]:
    """What the code of a function names and calls its variables; of a class, what its methods and properties name."""
    if isinstance(found, FunctionType):
        return {*found.__code__.co_names, *found.__code__.co_varnames}
    values = [value for kind in getattr(found, "__mro__", ()) for value in vars(kind).values()]
    values += [part for value in values if isinstance(value, property) for part in (value.fget, value.fset)]
    return {name for value in values if isinstance(value, FunctionType) for name in value.__code__.co_names}


def _describe_absent(names: tuple[str, ...]) -> str:
    """Which names a package does not have, and in which version."""
    package = names[0].partition(".")[0]
    text = ", ".join(name.replace(":", ".") for name in names)
    return f"{package}{_version(package)} has no {text}; everything else works"


def _version(package: str) -> str:
    from importlib import metadata  # takes longer to load than the whole check

    for distribution in (f"ros-{package.replace('_', '-')}", package):
        with suppress(metadata.PackageNotFoundError):
            return f" {metadata.version(distribution)}"
    return ""

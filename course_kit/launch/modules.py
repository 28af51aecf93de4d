"""What each module of `launch` and `launch_ros` holds, under the names the real ones have."""

from __future__ import annotations

import logging
import re
import sys
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import ModuleType

# module -> public name -> module of the course kit that has it, with another name behind a colon
CONTENTS: dict[str, dict[str, str]] = {
    "launch": {"LaunchContext": "entity", "LaunchDescription": "description"},
    "launch.actions": {
        **dict.fromkeys(("DeclareLaunchArgument", "GroupAction", "IncludeLaunchDescription", "LogInfo"), "actions"),
        **dict.fromkeys(("OpaqueFunction", "SetEnvironmentVariable", "TimerAction"), "actions"),
        **dict.fromkeys(("EmitEvent", "RegisterEventHandler"), "description"),
        "ExecuteProcess": "node",
        "Shutdown": "description:ShutdownAction",
    },
    "launch.conditions": dict.fromkeys(
        ("IfCondition", "LaunchConfigurationEquals", "UnlessCondition"), "substitutions"
    ),
    "launch.event_handlers": {"OnProcessExit": "description"},
    "launch.events": {"Shutdown": "description"},
    "launch.launch_description_sources": {"PythonLaunchDescriptionSource": "description"},
    "launch.logging": {"get_logger": "modules"},
    "launch.substitutions": {
        **dict.fromkeys(("LaunchConfiguration", "PathJoinSubstitution", "TextSubstitution"), "substitutions"),
        **dict.fromkeys(("Command", "EnvironmentVariable", "FindExecutable", "PythonExpression"), "substitutions"),
    },
    "launch_ros": {},
    "launch_ros.actions": {
        "Node": "node",
        "PushROSNamespace": "actions",
        "PushRosNamespace": "actions:PushROSNamespace",
        "SetParameter": "actions",
    },
    "launch_ros.descriptions": {"ParameterValue": "node"},
    "launch_ros.parameter_descriptions": {"ParameterValue": "node"},
    "launch_ros.substitutions": dict.fromkeys(("ExecutableInPackage", "FindPackageShare"), "substitutions"),
}
_SNAKE = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")
_FOR_CPP = re.compile("Composable|Lifecycle|StateTransition|ChangeState|lifecycle")


def explain_absence(name: str) -> str:
    """The sentence about something that is not here."""
    if _FOR_CPP.search(name):
        return (
            f"{name} is not part of the course kit's launch files: components and lifecycle nodes are what systems of "
            "compiled programs need. A full ROS 2 installation has them."
        )
    there = ", ".join(sorted(contents_of(name.rpartition(".")[0]) or CONTENTS["launch.actions"]))
    return (
        f"{name} is not part of the course kit's launch files, which know {there}. "
        "With a ROS 2 installation the whole of launch is there."
    )


def contents_of(module: str) -> dict[str, str] | None:
    """What a module holds; a class also lies in a separate one, such as `launch.actions.execute_process`."""
    if module in CONTENTS:
        return CONTENTS[module]
    parent, _, last = module.rpartition(".")
    inside = CONTENTS.get(parent, {})
    return {name: home for name, home in inside.items() if _SNAKE.sub("_", name).lower() == last} or None


def fill_module(module: ModuleType) -> None:
    """Put the names into a module that is being imported."""
    contents = contents_of(module.__name__) or {}
    for name, home in contents.items():
        where, _, other = home.partition(":")
        setattr(module, name, getattr(import_module(f"course_kit.launch.{where}"), other or name))
    module.__doc__ = "The course kit's subset of this module."

    def missing(name: str) -> object:
        if name.startswith("__"):  # what the import system and inspection look for
            raise AttributeError(name)
        full = f"{module.__name__}.{name}"
        if full in CONTENTS:  # `import launch; launch.actions.Node`
            return import_module(full)
        # An ImportError, so that `from launch.actions import ...` passes the sentence on.
        raise ImportError(explain_absence(full), name=module.__name__)

    namespace: dict[str, object] = vars(module)
    namespace["__getattr__"] = missing
    namespace["__all__"] = list(contents)


def get_logger(name: str = "launch.user") -> logging.Logger:
    """`launch.logging.get_logger`: a logger of Python's whose lines look like those of a launch."""
    logger = logging.getLogger(name)
    if not logger.handlers:
        handler = logging.StreamHandler(sys.stdout)
        handler.setFormatter(logging.Formatter("[%(levelname)s] [%(name)s]: %(message)s"))
        logger.addHandler(handler)
        logger.propagate = False
        logger.setLevel(logging.INFO)
    return logger

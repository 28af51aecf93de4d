"""What each module of `launch` and `launch_ros` holds, under the names the real ones have."""

from __future__ import annotations

import re
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import ModuleType

_SUBSTITUTIONS = {
    "AndSubstitution": "logic",
    "Command": "expressions",
    "EnvironmentVariable": "expressions",
    "EqualsSubstitution": "logic",
    "FileContent": "expressions",
    "FindExecutable": "expressions",
    "IfElseSubstitution": "logic",
    "LaunchConfiguration": "substitutions",
    "LaunchLogDir": "expressions",
    "LocalSubstitution": "substitutions",
    "NotEqualsSubstitution": "logic",
    "NotSubstitution": "logic",
    "OrSubstitution": "logic",
    "PathJoinSubstitution": "substitutions",
    "PythonExpression": "expressions",
    "TextSubstitution": "substitutions",
    "ThisLaunchFile": "substitutions",
    "ThisLaunchFileDir": "substitutions",
}
_PARAMETERS = {"Parameter": "parameters", "ParameterFile": "parameters", "ParameterValue": "parameters"}
# module -> public name -> module of the course kit that has it, with another name behind a colon
CONTENTS: dict[str, dict[str, str]] = {
    "launch": {
        "Action": "action",
        "Condition": "conditions",
        "Event": "events:LaunchEvent",
        "EventHandler": "event_handlers",
        "LaunchContext": "context",
        "LaunchDescription": "description",
        "LaunchDescriptionEntity": "entity:LaunchEntity",
        "LaunchDescriptionSource": "description",
        "SomeSubstitutionsType": "substitutions:Text",
        "Substitution": "substitutions",
    },
    "launch.actions": {
        "AppendEnvironmentVariable": "scopes",
        "DeclareLaunchArgument": "actions",
        "EmitEvent": "event_handlers",
        "ExecuteProcess": "execute_process",
        "GroupAction": "scopes",
        "IncludeLaunchDescription": "actions",
        "LogInfo": "actions",
        "OpaqueFunction": "actions",
        "RegisterEventHandler": "event_handlers",
        "SetEnvironmentVariable": "scopes",
        "SetLaunchConfiguration": "scopes",
        "Shutdown": "event_handlers:ShutdownAction",
        "TimerAction": "actions",
        "UnregisterEventHandler": "event_handlers",
        "UnsetEnvironmentVariable": "scopes",
        "UnsetLaunchConfiguration": "scopes",
    },
    "launch.conditions": {
        "IfCondition": "conditions",
        "LaunchConfigurationEquals": "conditions",
        "LaunchConfigurationNotEquals": "conditions",
        "UnlessCondition": "conditions",
    },
    "launch.event_handlers": {
        "OnExecutionComplete": "event_handlers",
        "OnProcessExit": "event_handlers",
        "OnProcessIO": "event_handlers",
        "OnProcessStart": "event_handlers",
        "OnShutdown": "event_handlers",
    },
    "launch.events": {"ExecutionComplete": "events", "Shutdown": "events", "matches_action": "events"},
    "launch.events.process": {
        "ProcessExited": "events",
        "ProcessIO": "events",
        "ProcessStarted": "events",
        "RunningProcessEvent": "events",
        "ShutdownProcess": "events",
        "SignalProcess": "events",
    },
    "launch.launch_description_sources": {
        "AnyLaunchDescriptionSource": "description",
        "FrontendLaunchDescriptionSource": "description:AnyLaunchDescriptionSource",
        "PythonLaunchDescriptionSource": "description",
    },
    "launch.some_substitutions_type": {"SomeSubstitutionsType": "substitutions:Text"},
    "launch.substitutions": _SUBSTITUTIONS,
    "launch_ros": {},
    "launch_ros.actions": {
        "Node": "node",
        "PushROSNamespace": "scopes",
        "PushRosNamespace": "scopes:PushROSNamespace",
        "SetParameter": "scopes",
        "SetRemap": "scopes",
    },
    "launch_ros.descriptions": {
        "Parameter": "parameters",
        "ParameterFile": "parameters",
        "ParameterValue": "parameters",
    },
    "launch_ros.parameter_descriptions": {
        "Parameter": "parameters",
        "ParameterFile": "parameters",
        "ParameterValue": "parameters",
    },
    "launch_ros.substitutions": {
        "ExecutableInPackage": "expressions",
        "FindPackagePrefix": "expressions",
        "FindPackageShare": "expressions",
    },
    "launch_xml": {},
    "launch_xml.launch_description_sources": {"XMLLaunchDescriptionSource": "description:AnyLaunchDescriptionSource"},
    "launch_yaml": {},
    "launch_yaml.launch_description_sources": {"YAMLLaunchDescriptionSource": "description:AnyLaunchDescriptionSource"},
}
_SNAKE = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")
_FOR_CPP = re.compile("Composable|Lifecycle|StateTransition|ChangeState|lifecycle")


def outside(name: str) -> str:
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
    """What a module holds; None when there is no such."""
    if module in CONTENTS:
        return CONTENTS[module]
    parent, _, last = module.rpartition(".")
    inside = CONTENTS.get(parent, {})
    return {name: home for name, home in inside.items() if _SNAKE.sub("_", name).lower() == last} or None


def fill(module: ModuleType) -> None:
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
        raise ImportError(outside(full), name=module.__name__)

    namespace: dict[str, object] = vars(module)
    namespace["__getattr__"] = missing
    namespace["__all__"] = list(contents)

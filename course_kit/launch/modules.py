"""What each module of `launch` and `launch_ros` holds, under the names the real ones have."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from types import ModuleType

# module -> public name -> module of the course kit that has it
CONTENTS: dict[str, dict[str, str]] = {
    "launch": {"LaunchContext": "context", "LaunchDescription": "description", "Substitution": "substitutions"},
    "launch.actions": {
        "DeclareLaunchArgument": "actions",
        "IncludeLaunchDescription": "actions",
        "LogInfo": "actions",
        "TimerAction": "actions",
    },
    "launch.substitutions": {
        "LaunchConfiguration": "substitutions",
        "PathJoinSubstitution": "substitutions",
        "TextSubstitution": "substitutions",
        "ThisLaunchFileDir": "substitutions",
    },
    "launch.launch_description_sources": {"PythonLaunchDescriptionSource": "description"},
    "launch_ros": {},
    "launch_ros.actions": {"Node": "node"},
}


def outside(name: str) -> str:
    """The sentence about something that is not here."""
    there = ", ".join(sorted(entry for contents in CONTENTS.values() for entry in contents))
    return (
        f"{name} is not part of the course kit's launch files, which know {there}. "
        "With a ROS 2 installation the whole of launch is there."
    )


def fill(module: ModuleType) -> None:
    """Put the names into a module that is being imported."""
    for name, home in CONTENTS[module.__name__].items():
        setattr(module, name, getattr(import_module(f"course_kit.launch.{home}"), name))
    module.__doc__ = "The course kit's subset of this module."

    def missing(name: str) -> NoReturn:
        if name.startswith("__"):  # what the import system and inspection look for
            raise AttributeError(name)
        # An ImportError, so that `from launch.actions import ...` passes the sentence on.
        raise ImportError(outside(f"{module.__name__}.{name}"), name=module.__name__)

    namespace: dict[str, object] = vars(module)
    namespace["__getattr__"] = missing
    namespace["__all__"] = list(CONTENTS[module.__name__])

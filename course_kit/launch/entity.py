"""What the parts of a launch description have in common: where they were written, and what is known as they run."""

from __future__ import annotations

import inspect
import os
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from course_kit.launch.errors import LaunchError, calling_place
from course_kit.ros.names import did_you_mean


class LaunchEntity:
    """A part of a launch description."""

    place: str
    given: tuple[object, ...]

    def __new__(cls, *given: Any, **keywords: Any) -> Any:
        """Note the place and what is given, and refuse arguments that there are not."""
        entity = super().__new__(cls)
        entity.place, entity.given = calling_place(), (*given, *keywords.values())
        if cls.__module__.startswith(f"{__package__}."):  # a class of the launch file's own takes what it likes
            known = _keywords(cls)
            for name in keywords.keys() - known:
                hint = did_you_mean(name, sorted(known))
                raise LaunchError(
                    f"{cls.__name__} has no argument '{name}' in the course kit's launch files.{hint}", entity.place
                )
        return entity


def _keywords(cls: type) -> set[str]:
    """The names of the arguments that a class and those above it take."""
    found: set[str] = set()
    for base in cls.__mro__[:-1]:
        if "__init__" in vars(base):
            parameters = inspect.signature(vars(base)["__init__"]).parameters.values()
            found |= {parameter.name for parameter in parameters if parameter.kind is not parameter.VAR_KEYWORD}
    return found - {"self"}


@dataclass
class LaunchContext:
    """The values of launch arguments, and where the file stands."""

    launch_configurations: dict[str, str] = field(default_factory=dict)
    file: Path = Path("launch.py")
    environment: dict[str, str] = field(default_factory=lambda: dict(os.environ))
    namespace: str = ""
    parameters: dict[str, object] = field(default_factory=dict)
    declared: set[str] = field(default_factory=set)
    service: Any = None  # the LaunchService that runs the file

    def for_included_file(self, file: Path) -> LaunchContext:
        """The context for an included file; its values are the same ones."""
        return replace(self, file=file)

    def copy_scope(self) -> LaunchContext:
        return replace(
            self,
            launch_configurations=dict(self.launch_configurations),
            environment=dict(self.environment),
            parameters=dict(self.parameters),
        )

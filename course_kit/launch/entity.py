"""What the parts of a launch description have in common: where they were written, and which arguments they take."""

from __future__ import annotations

import inspect
from typing import Any, ClassVar

from course_kit.launch.errors import LaunchError, calling_place
from course_kit.ros.names import did_you_mean


class LaunchEntity:
    """A part of a launch description."""

    OUTSIDE: ClassVar[frozenset[str]] = frozenset()
    REPLACED: ClassVar[dict[str, str]] = {}
    place: str

    def __new__(cls, *_: Any, **keywords: Any) -> Any:
        """Note the place, and refuse arguments that there are not."""
        entity = super().__new__(cls)
        entity.place = calling_place()
        if cls.__module__.startswith(f"{__package__}."):  # a class of the launch file's own takes what it likes
            for name in keywords:
                _check(cls, name, entity.place)
        return entity


def _check(cls: type[LaunchEntity], name: str, place: str) -> None:
    known = _keywords(cls)
    if name in known:
        return
    if name in cls.OUTSIDE:
        raise LaunchError(f"{cls.__name__}({name}=...) is not part of the course kit's subset of launch.", place)
    if name in cls.REPLACED:
        raise LaunchError(
            f"{cls.__name__}({name}=...) is from before ROS 2 Foxy: write {cls.REPLACED[name]}=... instead.", place
        )
    raise LaunchError(f"{cls.__name__} has no argument '{name}'.{did_you_mean(name, sorted(known))}", place)


def _keywords(cls: type) -> set[str]:
    """The names of the arguments that a class and those above it take."""
    found: set[str] = set()
    for one in cls.__mro__[:-1]:
        if "__init__" in vars(one):
            parameters = inspect.signature(vars(one)["__init__"]).parameters.values()
            found |= {parameter.name for parameter in parameters if parameter.kind is not parameter.VAR_KEYWORD}
    return found - {"self"}

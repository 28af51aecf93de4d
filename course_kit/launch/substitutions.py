"""Values that are known only when the launch file runs ("Using substitutions" among the ROS 2 tutorials)."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import PurePath
from typing import TYPE_CHECKING, Union

from course_kit.launch.entity import LaunchEntity
from course_kit.launch.errors import LaunchError
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from course_kit.launch.context import LaunchContext


class Substitution(LaunchEntity):
    """Something that becomes text."""

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        raise NotImplementedError(type(self).__name__)

    def describe(self) -> str:
        """How it is written, for `--show-args`."""
        return type(self).__name__


Text = Union[str, PurePath, Substitution, Iterable[object]]  # noqa: UP007 - evaluated at run time on Python 3.10, too


class TextSubstitution(Substitution):
    """Text as it stands."""

    def __init__(self, *, text: str) -> None:
        self.text = text

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        del context
        return self.text

    def describe(self) -> str:
        """The text in quotes."""
        return repr(self.text)


class LocalSubstitution(Substitution):
    """What an event handler knows of its event, such as LocalSubstitution("event.reason")."""

    def __init__(self, expression: str, description: str | None = None) -> None:
        self._expression, self._description = expression, description

    def perform(self, context: LaunchContext) -> str:
        """The value."""
        first, *names = self._expression.split(".")
        if first != "event" or context.event is None:
            raise LaunchError(f"{self.describe()}: only an event handler's actions have one, and it is called 'event'.")
        value: object = context.event
        for name in names:
            known = [each for each in dir(value) if not each.startswith("_")]
            if name not in known:
                raise LaunchError(f"{self.describe()}: it has no '{name}'.{did_you_mean(name, known)}")
            value = getattr(value, name)
        return str(value)

    def describe(self) -> str:
        """The value's name."""
        return self._description or f"LocalVar({self._expression!r})"


class LaunchConfiguration(Substitution):
    """The value of a launch argument."""

    def __init__(self, variable_name: Text, *, default: Text | None = None) -> None:
        self._name, self._default = variable_name, default

    @property
    def variable_name(self) -> Text:
        """The argument's name."""
        return self._name

    def perform(self, context: LaunchContext) -> str:
        """The value; a LaunchError when there is none."""
        name = as_text(self._name, context)
        if name in context.launch_configurations:
            return context.launch_configurations[name]
        if self._default is None:
            raise LaunchError(
                f"LaunchConfiguration('{name}') has no value: no DeclareLaunchArgument('{name}') stands before it, and "
                f"the command line has no {name}:=value.{did_you_mean(name, sorted(context.launch_configurations))}"
            )
        return as_text(self._default, context)

    def describe(self) -> str:
        """As in the launch file."""
        return f"LaunchConfiguration('{self._name}')"


class PathJoinSubstitution(Substitution):
    """Parts joined to a path."""

    def __init__(self, substitutions: Iterable[Text]) -> None:
        self._parts = list(substitutions)

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        return str(PurePath(*(as_text(part, context) for part in self._parts)))

    def describe(self) -> str:
        """Its parts."""
        return f"PathJoin({', '.join(map(described, self._parts))})"


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file."""

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        return str(context.file.parent)


class ThisLaunchFile(Substitution):
    """The path of the launch file."""

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        return str(context.file)


def as_text(value: object, context: LaunchContext) -> str:
    """Text, a substitution, or a list of both, as text."""
    if isinstance(value, Substitution):
        try:
            return value.perform(context)
        except LaunchError as error:
            raise error.at(value.place) from None
    if isinstance(value, (list, tuple)):
        return "".join(as_text(part, context) for part in value)
    if isinstance(value, bool):
        return str(value).lower()
    return str(value)


def has_substitution(value: object) -> bool:
    """Whether a value is only known when the file runs."""
    return isinstance(value, Substitution) or (
        isinstance(value, (list, tuple)) and any(isinstance(part, Substitution) for part in value)
    )


def described(value: object) -> str:
    """How a text is written, for `--show-args`."""
    if isinstance(value, Substitution):
        return value.describe()
    if isinstance(value, (list, tuple)):
        return " + ".join(described(part) for part in value)
    return repr(str(value))

"""Values that are known only when the launch file runs ("Using substitutions" among the ROS 2 tutorials)."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import PurePath
from typing import TYPE_CHECKING, Union

from course_kit.launch.entity import LaunchEntity
from course_kit.launch.errors import LaunchError
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.launch.context import LaunchContext
_WORDS = {"true": True, "1": True, "false": False, "0": False}


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


class Condition(LaunchEntity):
    """A condition."""

    def __init__(self, predicate: Callable[[LaunchContext], bool]) -> None:
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Whether it holds now."""
        return self._predicate(context)


class IfCondition(Condition):
    """Holds for "true" and "1", in any case of letters."""

    def __init__(self, predicate_expression: Text) -> None:
        super().__init__(lambda context: truth(predicate_expression, context, self.place))


class UnlessCondition(Condition):
    """Holds for "false" and "0", in any case of letters."""

    def __init__(self, predicate_expression: Text) -> None:
        super().__init__(lambda context: not truth(predicate_expression, context, self.place))


class LaunchConfigurationEquals(Condition):
    """Holds when a launch argument has a value."""

    def __init__(self, launch_configuration_name: str, expected_value: Text | None) -> None:
        super().__init__(lambda context: _equals(launch_configuration_name, expected_value, context))


class LaunchConfigurationNotEquals(Condition):
    """The opposite of LaunchConfigurationEquals."""

    def __init__(self, launch_configuration_name: str, expected_value: Text | None) -> None:
        super().__init__(lambda context: not _equals(launch_configuration_name, expected_value, context))


def truth(expression: Text | bool, context: LaunchContext, place: str = "") -> bool:
    """What "true", "false", "1" and "0" mean."""
    text = as_text(expression, context).strip()
    if text.lower() not in _WORDS:
        raise LaunchError(f"A condition is true or false, and {text!r} is neither.", place)
    return _WORDS[text.lower()]


def _equals(name: str, expected: Text | None, context: LaunchContext) -> bool:
    value = context.launch_configurations.get(name)
    return value == (None if expected is None else as_text(expected, context))

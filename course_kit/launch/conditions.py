"""When an action is done, and when not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.launch.entity import LaunchEntity
from course_kit.launch.errors import LaunchError
from course_kit.launch.substitutions import Text, as_text

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.launch.context import LaunchContext

_WORDS = {"true": True, "1": True, "false": False, "0": False}


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


def truth(expression: Text, context: LaunchContext, place: str = "") -> bool:
    """What "true", "false", "1" and "0" mean."""
    text = as_text(expression, context).strip()
    if text.lower() not in _WORDS:
        raise LaunchError(f"A condition is true or false, and {text!r} is neither.", place)
    return _WORDS[text.lower()]


def _equals(name: str, expected: Text | None, context: LaunchContext) -> bool:
    value = context.launch_configurations.get(name)
    return value == (None if expected is None else as_text(expected, context))

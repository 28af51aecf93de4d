"""The actions of a launch file; each does its part when it is reached ("Launch" among the ROS 2 tutorials)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.launch.description import LaunchDescription, PythonLaunchDescriptionSource, load
from course_kit.launch.errors import LaunchError, refuse
from course_kit.launch.substitutions import Text, as_text

if TYPE_CHECKING:
    from collections.abc import Iterable

    from course_kit.launch.context import LaunchContext
    from course_kit.launch.service import LaunchService


class Action:
    """Something a launch file does."""

    def execute(self, context: LaunchContext, service: LaunchService) -> None:
        """Do it.

        Raises:
            NotImplementedError: the action has not said.
        """
        raise NotImplementedError(type(self).__name__)


class DeclareLaunchArgument(Action):
    """An argument of the launch file, given as name:=value.

    Args:
        name: its name.
        default_value: used when it is not given; without one it must be.
        description: what it is for, for --show-args.
        choices: the values it may have.
    """

    def __init__(
        self,
        name: str,
        *,
        default_value: Text | None = None,
        description: str | None = None,
        choices: list[str] | None = None,
        **more: object,
    ) -> None:
        refuse("DeclareLaunchArgument", more)
        self.name, self.default_value, self.choices = name, default_value, choices
        self.description = description or "no description given"

    def execute(self, context: LaunchContext, service: LaunchService) -> None:
        """Give the argument its default, unless it has a value.

        Raises:
            LaunchError: it has no value, or one that is not among its choices.
        """
        del service
        values = context.launch_configurations
        if self.name not in values:
            if self.default_value is None:
                raise LaunchError(f"The launch argument '{self.name}' is required: add {self.name}:=value.")
            values[self.name] = as_text(self.default_value, context)
        if self.choices and values[self.name] not in self.choices:
            raise LaunchError(f"{self.name}:={values[self.name]} is not one of {', '.join(self.choices)}.")


class IncludeLaunchDescription(Action):
    """Another launch file as a part of this one.

    Args:
        launch_description_source: the file, as a PythonLaunchDescriptionSource or as a path.
        launch_arguments: pairs of names and values, such as `{"name": "value"}.items()`.
    """

    def __init__(
        self,
        launch_description_source: PythonLaunchDescriptionSource | Text,
        *,
        launch_arguments: Iterable[tuple[Text, Text]] | None = None,
        **more: object,
    ) -> None:
        refuse("IncludeLaunchDescription", more)
        if not isinstance(launch_description_source, PythonLaunchDescriptionSource):
            launch_description_source = PythonLaunchDescriptionSource(launch_description_source)
        self.source, self._arguments = launch_description_source, list(launch_arguments or [])

    def execute(self, context: LaunchContext, service: LaunchService) -> None:
        """Run the other file's actions, with the arguments in force from here on."""
        for name, value in self._arguments:
            context.launch_configurations[as_text(name, context)] = as_text(value, context)
        path = self.source.path(context)
        execute_all(load(path).entities, context.inside(path), service)


class TimerAction(Action):
    """Actions that come later.

    Args:
        period: seconds from the moment the timer is reached.
        actions: what is done then.
    """

    def __init__(self, *, period: Text | float, actions: Iterable[object], **more: object) -> None:
        refuse("TimerAction", more)
        self._period, self.actions = period, list(actions)

    def execute(self, context: LaunchContext, service: LaunchService) -> None:
        """Start the timer.

        Raises:
            LaunchError: its period is no number of seconds.
        """
        text = as_text(self._period, context)
        try:
            seconds = float(text)
        except ValueError:
            raise LaunchError(f"TimerAction(period={text!r}): a period is a number of seconds.") from None
        service.later(seconds, self.actions, context)


class LogInfo(Action):
    """A line on the screen.

    Args:
        msg: the text, also as substitutions.
    """

    def __init__(self, *, msg: Text, **more: object) -> None:
        refuse("LogInfo", more)
        self._message = msg

    def execute(self, context: LaunchContext, service: LaunchService) -> None:
        """Print the line."""
        service.say(f"[INFO] [launch.user]: {as_text(self._message, context)}")


def execute_all(entities: Iterable[object], context: LaunchContext, service: LaunchService) -> None:
    """Run actions in order.

    Args:
        entities: the actions; also whole launch descriptions.
        context: of the file they stand in.
        service: runs the processes.

    Raises:
        LaunchError: one of them is no action of the subset, or cannot be done.
    """
    for entity in entities:
        if isinstance(entity, LaunchDescription):
            execute_all(entity.entities, context, service)
        elif isinstance(entity, Action):
            entity.execute(context, service)
        else:
            raise LaunchError(f"{entity!r} is not part of the course kit's subset of launch.")

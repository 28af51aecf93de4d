"""The actions of a launch file; each does its part when it is reached ("Launch" among the ROS 2 tutorials)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.launch.action import Action, as_entities, execute_all
from course_kit.launch.description import LaunchDescriptionSource
from course_kit.launch.errors import LaunchError
from course_kit.launch.node import joined_namespace
from course_kit.launch.parameters import value_of
from course_kit.launch.substitutions import Text, as_text

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from course_kit.launch.context import LaunchContext
    from course_kit.launch.description import LaunchDescription
    from course_kit.launch.substitutions import Condition

_DEEPEST = 50  # files that include one another


class DeclareLaunchArgument(Action):
    """An argument of the launch file, given as name:=value."""

    def __init__(
        self,
        name: str,
        *,
        default_value: Text | None = None,
        description: Text | None = None,
        choices: list[str] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.name, self.default_value, self.choices = name, default_value, choices
        self.description = description or "no description given"

    def execute(self, context: LaunchContext) -> None:
        """Give the argument its default, unless it has a value."""
        values = context.launch_configurations
        context.declared.add(self.name)
        if self.name not in values:
            if self.default_value is None:
                raise LaunchError(f"The launch argument '{self.name}' is required: add {self.name}:=value.")
            values[self.name] = as_text(self.default_value, context)
        if self.choices and values[self.name] not in self.choices:
            raise LaunchError(f"{self.name}:={values[self.name]} is not one of {', '.join(map(str, self.choices))}.")


class IncludeLaunchDescription(Action):
    """Another launch file as a part of this one."""

    def __init__(
        self,
        launch_description_source: LaunchDescriptionSource | LaunchDescription | Text,
        *,
        launch_arguments: Iterable[tuple[Text, Text]] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.source = LaunchDescriptionSource.of(launch_description_source)
        self._arguments = list(launch_arguments or [])

    def execute(self, context: LaunchContext) -> None:
        """Run the other file's actions, with the arguments in force from here on."""
        for name, value in self._arguments:
            context.launch_configurations[as_text(name, context)] = as_text(value, context)
        if context.depth > _DEEPEST:
            raise LaunchError(f"{context.file.name} includes itself: {_DEEPEST} launch files are nested.")
        path = self.source.path(context)
        execute_all(self.source.description(path), context.inside(path))


class TimerAction(Action):
    """Actions that come later."""

    def __init__(
        self,
        *,
        period: Text | float,
        actions: Iterable[object],
        cancel_on_shutdown: object = True,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        del cancel_on_shutdown
        self._period, self.actions, self._cancelled = period, list(actions), False

    def cancel(self) -> None:
        """Do nothing when it is over."""
        self._cancelled = True

    def execute(self, context: LaunchContext) -> None:
        """Start the timer."""
        text = as_text(self._period, context)
        try:
            seconds = float(text)
        except ValueError:
            raise LaunchError(f"TimerAction(period={text!r}): a period is a number of seconds.") from None
        context.service.later(seconds, lambda: execute_all([] if self._cancelled else self.actions, context))

    def sub_entities(self) -> Iterable[object]:
        """The actions."""
        return self.actions


class LogInfo(Action):
    """A line on the screen."""

    def __init__(self, *, msg: Text, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._message = msg

    def execute(self, context: LaunchContext) -> None:
        """Print the line."""
        context.service.say(f"[INFO] [launch.user]: {as_text(self._message, context)}")


class OpaqueFunction(Action):
    """A Python function that is called when it is reached, when the values of launch arguments are known."""

    def __init__(
        self,
        *,
        function: Callable[..., object],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self._function, self._args, self._kwargs = function, list(args or []), dict(kwargs or {})

    def execute(self, context: LaunchContext) -> object:
        """Call it."""
        return as_entities(self._function(context, *self._args, **self._kwargs))


class GroupAction(Action):
    """Actions with a scope of their own."""

    def __init__(
        self,
        actions: Iterable[object],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Text, Text] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.actions, self._scoped, self._forwarding = list(actions), scoped, forwarding
        self._values = dict(launch_configurations or {})

    def execute(self, context: LaunchContext) -> None:
        """Run the actions."""
        values = {as_text(name, context): as_text(value, context) for name, value in self._values.items()}
        inner = context.scoped(forwarding=self._forwarding) if self._scoped else context
        inner.launch_configurations |= values
        execute_all(self.actions, inner)

    def sub_entities(self) -> Iterable[object]:
        """The actions."""
        return self.actions


class SetEnvironmentVariable(Action):
    """An environment variable for the processes after it."""

    def __init__(self, name: Text, value: Text, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._name, self._value = name, value

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        context.environment[as_text(self._name, context)] = as_text(self._value, context)


class PushROSNamespace(Action):
    """A namespace for the nodes after it, within the one there is."""

    def __init__(self, namespace: Text, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._namespace = namespace

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        context.namespace = joined_namespace(context.namespace, as_text(self._namespace, context))


class SetParameter(Action):
    """A parameter for all nodes after it."""

    def __init__(self, name: Text, value: object, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._name, self._value = name, value

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        name = as_text(self._name, context)
        context.parameters[name] = value_of(name, self._value, context)

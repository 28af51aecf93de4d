"""The actions of a launch file; each does its part when it is reached ("Launch" among the ROS 2 tutorials)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.launch import package_index
from course_kit.launch.description import (
    Action,
    LaunchDescription,
    PythonLaunchDescriptionSource,
    as_entities,
    execute_all,
    load_description,
)
from course_kit.launch.entity import LaunchContext
from course_kit.launch.errors import LaunchError
from course_kit.launch.node import join_namespace, value_of
from course_kit.launch.substitutions import Text, as_text, describe_text
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
    from pathlib import Path

    from course_kit.launch.substitutions import Condition


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
        launch_description_source: PythonLaunchDescriptionSource | Text,
        *,
        launch_arguments: Iterable[tuple[Text, Text]] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        source = launch_description_source
        self.path = source.launch_file_path if isinstance(source, PythonLaunchDescriptionSource) else source
        self._arguments = list(launch_arguments or [])

    def execute(self, context: LaunchContext) -> None:
        """Run the other file's actions, with the arguments as they are from here on."""
        for name, value in self._arguments:
            context.launch_configurations[as_text(name, context)] = as_text(value, context)
        path = context.file.parent / as_text(self.path, context)
        execute_all(load_description(path), context.for_included_file(path))


class TimerAction(Action):
    """Actions that come later."""

    def __init__(self, *, period: Text | float, actions: Iterable[object], condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._period, self.actions = period, list(actions)

    def execute(self, context: LaunchContext) -> None:
        text = as_text(self._period, context)
        try:
            seconds = float(text)
        except ValueError:
            raise LaunchError(f"TimerAction(period={text!r}): a period is a number of seconds.") from None
        context.service.call_later(seconds, lambda: execute_all(self.actions, context))


class LogInfo(Action):
    """A line on the screen."""

    def __init__(self, *, msg: Text, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._message = msg

    def execute(self, context: LaunchContext) -> None:
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
        return as_entities(self._function(context, *self._args, **self._kwargs))


class GroupAction(Action):
    """Actions with their own scope."""

    def __init__(self, actions: Iterable[object], *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self.actions = list(actions)

    def execute(self, context: LaunchContext) -> None:
        execute_all(self.actions, context.copy_scope())

    def sub_entities(self) -> Iterable[object]:
        return self.actions


class SetEnvironmentVariable(Action):
    """An environment variable for the processes after it."""

    def __init__(self, name: Text, value: Text, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._name, self._value = name, value

    def execute(self, context: LaunchContext) -> None:
        context.environment[as_text(self._name, context)] = as_text(self._value, context)


class PushROSNamespace(Action):
    """A namespace for the nodes after it, within the one there is."""

    def __init__(self, namespace: Text, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._namespace = namespace

    def execute(self, context: LaunchContext) -> None:
        context.namespace = join_namespace(context.namespace, as_text(self._namespace, context))


class SetParameter(Action):
    """A parameter for all nodes after it."""

    def __init__(self, name: Text, value: object, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._name, self._value = name, value

    def execute(self, context: LaunchContext) -> None:
        name = as_text(self._name, context)
        context.parameters[name] = value_of(name, self._value, context)


def show_arguments(file: Path) -> str:
    """The arguments of a file and of those it includes, as the real command shows them: of several, the first."""
    package_index.make_known([file.parent])
    declared: dict[str, DeclareLaunchArgument] = {}
    context = LaunchContext({}, file)
    for argument in _list_declared(load_description(file).entities, context):
        declared.setdefault(argument.name, argument)
    text = "\n\n".join(_describe_argument(argument, context) for argument in declared.values()) or "  No arguments."
    return f"Arguments (pass arguments as '<name>:=<value>'):\n\n{text}"


def doubt_arguments(given: Iterable[str], declared: Collection[str]) -> list[str]:
    """Sentences about arguments that no launch file has declared, but one with nearly that name."""
    names = [name for name in given if name not in declared]
    hints = ((name, did_you_mean(name, sorted(declared))) for name in names)
    return [f"No launch file declares the argument '{name}'.{hint}" for name, hint in hints if hint]


def not_an_argument(word: str) -> str:
    """The sentence about a word that gives no value; `speed=3` misses a colon."""
    name, separator, value = word.partition("=")
    return f"{word!r} is not a launch argument: write {name}:={value if separator else 'value'}."


def _describe_argument(argument: DeclareLaunchArgument, context: LaunchContext) -> str:
    choices = f" Valid choices are: {argument.choices}" if argument.choices else ""
    lines = [f"    '{argument.name}':", f"        {as_text(argument.description, context)}{choices}"]
    if argument.default_value is not None:
        lines.append(f"        (default: {describe_text(argument.default_value)})")
    return "\n".join(lines)


def _list_declared(entities: Iterable[object], context: LaunchContext) -> Iterator[DeclareLaunchArgument]:
    for entity in entities:
        if isinstance(entity, DeclareLaunchArgument):
            yield entity
            if entity.default_value is not None:  # a path of an included file may be made of it
                context.launch_configurations.setdefault(entity.name, str(entity.default_value))
        elif isinstance(entity, LaunchDescription):
            yield from _list_declared(entity.entities, context)
        elif isinstance(entity, IncludeLaunchDescription):
            yield from _list_included(entity, context)
        elif isinstance(entity, Action):
            yield from _list_declared(entity.sub_entities(), context)


def _list_included(entity: IncludeLaunchDescription, context: LaunchContext) -> Iterator[DeclareLaunchArgument]:
    """The arguments of an included file; none where it depends on what only a running launch knows."""
    try:
        path = context.file.parent / as_text(entity.path, context)
        inner = load_description(path).entities
    except LaunchError:
        return
    if path != context.file:
        yield from _list_declared(inner, context.for_included_file(path))

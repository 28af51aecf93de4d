"""The arguments of a launch file, for `--show-args`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, TimerAction
from course_kit.launch.context import LaunchContext
from course_kit.launch.description import LaunchDescription, load
from course_kit.launch.substitutions import Substitution

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path


def show_arguments(file: Path) -> str:
    """The arguments of a file and of those it includes, as the real command shows them."""
    declared = {argument.name: argument for argument in _declared(load(file).entities, LaunchContext({}, file))}
    if not declared:
        return "Arguments (pass arguments as '<name>:=<value>'):\n\n  No arguments."
    return "Arguments (pass arguments as '<name>:=<value>'):\n\n" + "\n\n".join(map(_shown, declared.values()))


def _shown(argument: DeclareLaunchArgument) -> str:
    choices = f" Valid choices are: {argument.choices}" if argument.choices else ""
    lines = [f"    '{argument.name}':", f"        {argument.description}{choices}"]
    if argument.default_value is not None:
        lines.append(f"        (default: {_default(argument.default_value)})")
    return "\n".join(lines)


def _default(value: object) -> str:
    if isinstance(value, Substitution):
        return value.describe()
    if isinstance(value, (list, tuple)):
        return " + ".join(_default(part) for part in value)
    return repr(str(value))


def _declared(entities: Iterable[object], context: LaunchContext) -> Iterator[DeclareLaunchArgument]:
    for entity in entities:
        if isinstance(entity, DeclareLaunchArgument):
            yield entity
            if entity.default_value is not None:  # a path of an included file may be made of it
                context.launch_configurations.setdefault(entity.name, str(entity.default_value))
        elif isinstance(entity, LaunchDescription):
            yield from _declared(entity.entities, context)
        elif isinstance(entity, TimerAction):
            yield from _declared(entity.actions, context)
        elif isinstance(entity, IncludeLaunchDescription):
            path = entity.source.path(context)
            yield from _declared(load(path).entities, context.inside(path))

"""The arguments of a launch file: for `--show-args`, and what was meant by a word that is none."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.launch import package_index
from course_kit.launch.action import Action
from course_kit.launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from course_kit.launch.context import LaunchContext
from course_kit.launch.description import LaunchDescription, load
from course_kit.launch.errors import LaunchError
from course_kit.launch.substitutions import as_text, described
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator
    from pathlib import Path

_HEAD = "Arguments (pass arguments as '<name>:=<value>'):\n\n"


def show_arguments(file: Path) -> str:
    """The arguments of a file and of those it includes, as the real command shows them: of several, the first."""
    package_index.make_known([file.parent])
    declared: dict[str, DeclareLaunchArgument] = {}
    context = LaunchContext({}, file)
    for argument in _declared(load(file).entities, context):
        declared.setdefault(argument.name, argument)
    return _HEAD + ("\n\n".join(_shown(one, context) for one in declared.values()) or "  No arguments.")


def doubts(given: Iterable[str], declared: Collection[str]) -> list[str]:
    """Sentences about arguments that no launch file has declared, but one with nearly that name."""
    names = [name for name in given if name not in declared]
    hints = ((name, did_you_mean(name, sorted(declared))) for name in names)
    return [f"No launch file declares the argument '{name}'.{hint}" for name, hint in hints if hint]


def not_an_argument(word: str) -> str:
    """The sentence about a word that gives no value; `speed=3` misses a colon."""
    name, separator, value = word.partition("=")
    return f"{word!r} is not a launch argument: write {name}:={value if separator else 'value'}."


def _shown(argument: DeclareLaunchArgument, context: LaunchContext) -> str:
    choices = f" Valid choices are: {argument.choices}" if argument.choices else ""
    lines = [f"    '{argument.name}':", f"        {as_text(argument.description, context)}{choices}"]
    if argument.default_value is not None:
        lines.append(f"        (default: {described(argument.default_value)})")
    return "\n".join(lines)


def _declared(entities: Iterable[object], context: LaunchContext) -> Iterator[DeclareLaunchArgument]:
    for entity in entities:
        if isinstance(entity, DeclareLaunchArgument):
            yield entity
            if entity.default_value is not None:  # a path of an included file may be made of it
                context.launch_configurations.setdefault(entity.name, str(entity.default_value))
        elif isinstance(entity, LaunchDescription):
            yield from _declared(entity.entities, context)
        elif isinstance(entity, IncludeLaunchDescription):
            yield from _included(entity, context)
        elif isinstance(entity, Action):
            yield from _declared(entity.sub_entities(), context)


def _included(entity: IncludeLaunchDescription, context: LaunchContext) -> Iterator[DeclareLaunchArgument]:
    """The arguments of an included file; none where it depends on what only a running launch knows."""
    try:
        path = entity.source.path(context)
        inner = entity.source.description(path).entities
    except LaunchError:
        return
    if path != context.file:
        yield from _declared(inner, context.inside(path))

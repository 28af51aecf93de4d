"""A launch file and what it describes."""

from __future__ import annotations

import sys
from importlib.util import module_from_spec, spec_from_file_location
from typing import TYPE_CHECKING

from course_kit.launch.entity import LaunchEntity
from course_kit.launch.errors import LaunchError, in_a_sentence, place_in
from course_kit.launch.substitutions import Text, as_text

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from course_kit.launch.context import LaunchContext

_GENERATE = "generate_launch_description"
_OTHER_KINDS = {".xml": "XML", ".launch": "XML, as ROS 1 has them,", ".yaml": "YAML", ".yml": "YAML"}


class LaunchDescription:
    """The actions of a launch file, in order."""

    def __init__(self, initial_entities: Iterable[object] | None = None) -> None:
        self.entities = list(initial_entities or [])

    def add_action(self, action: object) -> None:
        """Add an action at the end."""
        self.entities.append(action)

    add_entity = add_action


class LaunchDescriptionSource(LaunchEntity):
    """A launch file to include."""

    def __init__(self, launch_file_path: Text | LaunchDescription) -> None:
        self._path = launch_file_path

    @classmethod
    def of(cls, source: LaunchDescriptionSource | LaunchDescription | Text) -> LaunchDescriptionSource:
        """A source, whatever is given as one."""
        return source if isinstance(source, LaunchDescriptionSource) else PythonLaunchDescriptionSource(source)

    def path(self, context: LaunchContext) -> Path:
        """Where the file is; the including one for a description that is there already."""
        if isinstance(self._path, LaunchDescription):
            return context.file
        return context.file.parent / as_text(self._path, context)

    def description(self, path: Path) -> LaunchDescription:
        """What it describes."""
        return self._path if isinstance(self._path, LaunchDescription) else load(path)


class PythonLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file in Python."""


def load(path: Path) -> LaunchDescription:
    """What a launch file describes."""
    if path.suffix in _OTHER_KINDS:
        raise LaunchError(
            f"{path.name} is a launch file in {_OTHER_KINDS[path.suffix]}. The course reads launch files in Python "
            "only; a full ROS 2 installation reads this one, too."
        )
    if not path.is_file():
        raise LaunchError(f"There is no launch file {path}.")
    spec = spec_from_file_location(f"launch_file_{path.name.partition('.')[0]}", path)
    if path.suffix != ".py" or spec is None or spec.loader is None:
        raise LaunchError(f"{path} is not a launch file in Python, *.launch.py.")
    module = module_from_spec(spec)
    writes, sys.dont_write_bytecode = sys.dont_write_bytecode, True  # no __pycache__ beside the learner's file
    try:
        spec.loader.exec_module(module)
        generate = getattr(module, _GENERATE, None)
        description = generate() if callable(generate) else None
    except LaunchError as error:
        raise error.at(place_in(path, error)) from None
    except SystemExit as leaving:
        raise LaunchError(f"The launch file ends itself, with sys.exit({leaving.code!r}).", path.name) from None
    except Exception as error:
        raise in_a_sentence(error, path) from error
    finally:
        sys.dont_write_bytecode = writes
    if not isinstance(description, LaunchDescription):
        raise LaunchError(f"{path.name} has no function {_GENERATE}() that returns a LaunchDescription.")
    return description

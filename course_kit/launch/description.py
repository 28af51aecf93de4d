"""A launch file and what it describes."""

from __future__ import annotations

import sys
from importlib.util import module_from_spec, spec_from_file_location
from typing import TYPE_CHECKING

from course_kit.launch.errors import LaunchError
from course_kit.launch.substitutions import Text, as_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from course_kit.launch.context import LaunchContext

_LAUNCH_FILE = "a launch file in Python, *.launch.py"


class LaunchDescription:
    """The actions of a launch file, in order.

    Args:
        initial_entities: the actions.
    """

    def __init__(self, initial_entities: Iterable[object] | None = None) -> None:
        self.entities = list(initial_entities or [])

    def add_action(self, action: object) -> None:
        """Add an action at the end."""
        self.entities.append(action)

    add_entity = add_action


class PythonLaunchDescriptionSource:
    """A launch file to include.

    Args:
        launch_file_path: its path, also as substitutions; relative to the including file's folder.
    """

    def __init__(self, launch_file_path: Text) -> None:
        self._path = launch_file_path

    def path(self, context: LaunchContext) -> Path:
        """Where the file is."""
        return context.file.parent / as_text(self._path, context)


def load(path: Path) -> LaunchDescription:
    """What a launch file describes.

    Raises:
        LaunchError: no launch file, or one with a mistake; the message names file and line.
    """
    if path.suffix != ".py":
        raise LaunchError(f"{path} is not {_LAUNCH_FILE}; XML and YAML are not part of the course kit's subset.")
    if not path.is_file():
        raise LaunchError(f"There is no launch file {path}.")
    spec = spec_from_file_location(f"launch_file_{path.name.partition('.')[0]}", path)
    if spec is None or spec.loader is None:
        raise LaunchError(f"{path} is not {_LAUNCH_FILE}.")
    module = module_from_spec(spec)
    writes, sys.dont_write_bytecode = sys.dont_write_bytecode, True  # no __pycache__ beside the learner's file
    try:
        spec.loader.exec_module(module)
        generate = getattr(module, "generate_launch_description", None)
        description = generate() if callable(generate) else None
    except LaunchError:
        raise
    except Exception as error:
        raise LaunchError(_where(error, path)) from error
    finally:
        sys.dont_write_bytecode = writes
    if not isinstance(description, LaunchDescription):
        raise LaunchError(
            f"{path.name} has no function generate_launch_description() that returns a LaunchDescription."
        )
    return description


def _where(error: Exception, path: Path) -> str:
    """The error and the line of the launch file it comes from."""
    lines = [frame for frame in _line_numbers(error) if frame[0] == str(path)]
    line = getattr(error, "lineno", None) if isinstance(error, SyntaxError) else (lines[-1][1] if lines else None)
    place = f"{path.name}, line {line}" if line else path.name
    message = error.msg if isinstance(error, SyntaxError) else str(error)
    return f"{place}: {message}" if isinstance(error, ImportError) else f"{place}: {type(error).__name__}: {message}"


def _line_numbers(error: Exception) -> Iterator[tuple[str, int]]:
    trace = error.__traceback__
    while trace is not None:
        yield trace.tb_frame.f_code.co_filename, trace.tb_lineno
        trace = trace.tb_next

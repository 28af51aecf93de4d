"""`launch_ros.actions.Node`: a process with a ROS node."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import TYPE_CHECKING

import yaml

from course_kit.launch.actions import Action
from course_kit.launch.errors import LaunchError, refuse
from course_kit.launch.executables import find
from course_kit.launch.substitutions import Substitution, Text, as_text, has_substitution

if TYPE_CHECKING:
    from collections.abc import Iterable

    from course_kit.launch.context import LaunchContext
    from course_kit.launch.service import LaunchService

_OUTPUTS = {"screen": True, "both": True, "log": False, "own_log": False}


class Node(Action):
    """A node, started as `ros2 run package executable` would.

    Args:
        executable: of the package, or the path of a program when there is no package.
        package: see `course_kit.launch.executables.find`.
        name: the node's name instead of the program's own.
        namespace: the node's namespace.
        parameters: dicts of values, and paths of parameter files; later ones win.
        remappings: pairs of names, old and new.
        arguments: the program's own arguments.
        output: "screen" or "both" for everything, "log" (the default) for stderr only, the rest into the log file.
        emulate_tty: taken for the programs' sake; their output is never held back here.
    """

    def __init__(  # noqa: PLR0913 - launch_ros has them
        self,
        *,
        executable: Text,
        package: Text | None = None,
        name: Text | None = None,
        namespace: Text | None = None,
        parameters: Iterable[object] | None = None,
        remappings: Iterable[tuple[Text, Text]] | None = None,
        arguments: Iterable[Text] | None = None,
        output: Text = "log",
        emulate_tty: bool = False,
        **more: object,
    ) -> None:
        refuse("Node", more)
        del emulate_tty
        self._executable, self._package = executable, package
        self._name, self._namespace = name, namespace
        self._parameters, self._remappings = list(parameters or []), list(remappings or [])
        self._arguments, self._output = list(arguments or []), output

    def execute(self, context: LaunchContext, service: LaunchService) -> None:
        """Start the process.

        Raises:
            LaunchError: it has options that the course does not know, or its program is not found.
        """
        output = as_text(self._output, context)
        if output not in _OUTPUTS:
            raise LaunchError(f"Node(output={output!r}): the course kit knows {', '.join(_OUTPUTS)}.")
        command = self._program(context)
        label = Path(as_text(self._executable, context)).name
        temporary: list[Path] = []
        command += [as_text(argument, context) for argument in self._arguments]
        command += ["--ros-args", *self._ros_arguments(context, temporary)]
        service.start(command, label, show_stdout=_OUTPUTS[output], temporary=temporary)

    def _program(self, context: LaunchContext) -> list[str]:
        package = None if self._package is None else as_text(self._package, context)
        return find(package, as_text(self._executable, context), [context.file.parent])

    def _ros_arguments(self, context: LaunchContext, temporary: list[Path]) -> list[str]:
        arguments: list[str] = []
        if self._name is not None:
            arguments += ["-r", f"__node:={as_text(self._name, context)}"]
        if self._namespace:
            namespace = as_text(self._namespace, context)
            arguments += ["-r", f"__ns:={namespace if namespace.startswith('/') else f'/{namespace}'}"]
        for parameters in self._parameters:
            arguments += ["--params-file", self._parameter_file(parameters, context, temporary)]
        for old, new in self._remappings:
            arguments += ["-r", f"{as_text(old, context)}:={as_text(new, context)}"]
        return arguments

    def _parameter_file(self, parameters: object, context: LaunchContext, temporary: list[Path]) -> str:
        if isinstance(parameters, Mapping):
            values = {as_text(name, context): _value(value, context) for name, value in parameters.items()}
            with tempfile.NamedTemporaryFile("w", prefix="launch_params_", encoding="utf-8", delete=False) as file:
                yaml.safe_dump({"/**": {"ros__parameters": values}}, file, default_flow_style=False)
            temporary.append(Path(file.name))
            return file.name
        if isinstance(parameters, (str, PurePath, Substitution, list, tuple)):
            path = context.file.parent / as_text(parameters, context)
            if not path.is_file():
                raise LaunchError(f"There is no parameter file {path}.")
            return str(path)
        raise LaunchError(f"Node(parameters=[{parameters!r}]): expected a dict of values or the path of a file.")


def _value(value: object, context: LaunchContext) -> object:
    """A parameter's value; what substitutions bring is read as YAML, as typed on a command line."""
    if has_substitution(value):
        return yaml.safe_load(as_text(value, context))
    if isinstance(value, Mapping):
        return {as_text(name, context): _value(part, context) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_value(part, context) for part in value]
    if isinstance(value, (bool, int, float, str)):
        return value
    raise LaunchError(f"{value!r} is not a parameter value: expected a bool, int, float, str or a list of those.")

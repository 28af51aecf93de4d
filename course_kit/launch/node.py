"""`launch_ros.actions.Node`: a process with a ROS node."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, ClassVar

import yaml

from course_kit.launch.errors import LaunchError
from course_kit.launch.executables import find
from course_kit.launch.execute_process import ExecuteProcess
from course_kit.launch.expressions import replace_substitutions
from course_kit.launch.parameters import Parameter, ParameterFile, value_of, values_of
from course_kit.launch.substitutions import Substitution, Text, as_text, truth

if TYPE_CHECKING:
    from collections.abc import Iterable

    from course_kit.launch.context import LaunchContext


class Node(ExecuteProcess):
    """A node, started as `ros2 run package executable` would."""

    OUTSIDE: ClassVar[frozenset[str]] = ExecuteProcess.OUTSIDE | {"cmd"}
    REPLACED: ClassVar[dict[str, str]] = {
        "node_executable": "executable",
        "node_name": "name",
        "node_namespace": "namespace",
    }

    def __init__(  # noqa: PLR0913 - launch_ros has them
        self,
        *,
        executable: Text,
        package: Text | None = None,
        name: Text | None = None,
        namespace: Text | None = None,
        exec_name: Text | None = None,
        parameters: Iterable[object] | None = None,
        remappings: Iterable[tuple[Text, Text]] | None = None,
        ros_arguments: Iterable[Text] | None = None,
        arguments: Iterable[Text] | None = None,
        **process: Any,
    ) -> None:
        super().__init__(cmd=(), name=exec_name, **process)
        self._executable, self._package = executable, package
        self._node_name, self._namespace = name, namespace
        if isinstance(parameters, (str, Mapping)):
            raise LaunchError("Node(parameters=...) is a list: write [ and ] around the dict or the path.")
        self._parameters, self._remappings = list(parameters or []), list(remappings or [])
        self._ros_arguments, self._arguments = list(ros_arguments or []), list(arguments or [])

    def command(self, context: LaunchContext, temporary: list[Path]) -> list[str]:
        """The program, its arguments, and what ROS is told."""
        package = None if self._package is None else as_text(self._package, context)
        command = find(package, as_text(self._executable, context), [context.file.parent])
        command += [as_text(argument, context) for argument in self._arguments]
        if self._ros_arguments:
            command += ["--ros-args", *(as_text(argument, context) for argument in self._ros_arguments)]
        return [*command, "--ros-args", *self._told(context, temporary)]

    def label(self, context: LaunchContext, command: list[str]) -> str:
        """What the lines of the process begin with."""
        if self._name is not None:
            return super().label(context, command)
        return Path(as_text(self._executable, context)).name

    def _told(self, context: LaunchContext, temporary: list[Path]) -> list[str]:
        name = None if self._node_name is None else as_text(self._node_name, context)
        own = None if self._namespace is None else as_text(self._namespace, context)
        namespace = joined_namespace(context.namespace, own or "")
        arguments = [] if name is None else ["-r", f"__node:={name}"]
        arguments += ["-r", f"__ns:={namespace}"] if namespace else []
        for given, value in context.parameters.items():
            arguments += ["-p", f"{given}:={_typed(value)}"]
        whose = f"{namespace.rstrip('/')}/{name}" if name is not None and namespace else "/**"
        for parameters in self._parameters:
            arguments += self._given(parameters, whose, context, temporary)
        pairs = [(as_text(old, context), as_text(new, context)) for old, new in self._remappings]
        for old, new in pairs:  # of two for one name the first counts
            arguments += ["-r", f"{old}:={new}"]
        return arguments

    def _given(self, parameters: object, whose: str, context: LaunchContext, temporary: list[Path]) -> list[str]:
        """The arguments for one entry of `parameters`."""
        if isinstance(parameters, Mapping):
            values = values_of(parameters, context)
            text = yaml.safe_dump({whose: {"ros__parameters": values}}, default_flow_style=False)
            return self._file_of(text, temporary)
        if isinstance(parameters, Parameter):
            name = as_text(parameters.name, context)
            return ["-p", f"{name}:={_typed(value_of(name, parameters.value, context))}"]
        replaces = isinstance(parameters, ParameterFile) and truth(parameters.allow_substs, context, parameters.place)
        if isinstance(parameters, ParameterFile):
            parameters = parameters.path
        if isinstance(parameters, (str, PurePath, Substitution, list, tuple)):
            path = context.file.parent / as_text(parameters, context)
            if path.is_file() and replaces:
                return self._file_of(replace_substitutions(path.read_text(encoding="utf-8"), context), temporary)
            if path.is_file():
                return ["--params-file", str(path)]
            context.service.say(
                f"[WARNING] [launch]: {self.place}: there is no parameter file {path}; the node starts without it."
            )
            return []
        raise LaunchError(f"Node(parameters=[{parameters!r}]): expected a dict of values or the path of a file.")

    @staticmethod
    def _file_of(text: str, temporary: list[Path]) -> list[str]:
        with tempfile.NamedTemporaryFile("w", prefix="launch_params_", encoding="utf-8", delete=False) as file:
            file.write(text)
        temporary.append(Path(file.name))
        return ["--params-file", file.name]


def joined_namespace(outer: str, inner: str) -> str:
    """A namespace within another one, absolute; empty where there is none."""
    if inner.startswith("/"):
        return inner
    joined = "/".join(part for part in (outer.strip("/"), inner.strip("/")) if part)
    return f"/{joined}" if joined else ""


def _typed(value: object) -> str:
    """A value as `-p name:=value` wants it."""
    return yaml.safe_dump(value, default_flow_style=True).removesuffix("...\n").strip()

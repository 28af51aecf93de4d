"""The processes of a launch file: any program, and programs with a ROS node and its parameters."""

from __future__ import annotations

import sys
import tempfile
import typing
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

import yaml

from course_kit.environment.paths import with_scripts_first
from course_kit.launch.description import Action, OnProcessExit, Reaction, as_entities
from course_kit.launch.entity import LaunchEntity
from course_kit.launch.errors import LaunchError, ProgramError
from course_kit.launch.executables import find_command
from course_kit.launch.substitutions import (
    ExecutableInPackage,
    Substitution,
    Text,
    as_text,
    has_substitution,
    read_truth,
)

if TYPE_CHECKING:
    from course_kit.launch.entity import LaunchContext
    from course_kit.launch.substitutions import Condition

_SHELL = ("/bin/sh", "-c")
_PYTHONS = ("python", "python3")
# output= -> whether stdout and stderr belong on the screen; all of it goes into the log file
_OUTPUTS = {"screen": (True, True), "both": (True, True), "log": (False, True)}
_PLAIN = (bool, int, float, str)
_EXPECTED = "expected a bool, int, float, str or a list of one of these"


class ParameterValue(LaunchEntity):
    """A parameter's value with its type."""

    def __init__(self, value: object, *, value_type: Any = None) -> None:
        self.value, self.value_type = value, value_type

    def evaluate(self, context: LaunchContext) -> object:
        kind = self.value_type
        if kind is None:
            return value_of("", self.value, context)
        text = as_text(self.value, context) if _is_text(self.value) else None
        if kind is str and text is not None:
            return text
        read = value_of("", self.value, context) if text is None else _read("", text)
        inner = typing.get_args(kind)
        try:
            if inner:
                return [_convert_value(part, inner[0]) for part in typing.cast("Iterable[object]", read)]
            return _convert_value(read, kind)
        except (TypeError, ValueError):
            raise LaunchError(f"ParameterValue({text or read!r}) is no {getattr(kind, '__name__', kind)}.") from None


def values_of(parameters: Mapping[Any, Any], context: LaunchContext, before: str = "") -> dict[str, object]:
    """The values of a dict of parameters; those of a dict within it have dotted names."""
    found: dict[str, object] = {}
    for key, value in parameters.items():
        name = before + as_text(key, context)
        if isinstance(value, Mapping):
            found |= values_of(value, context, f"{name}.")
        else:
            found[name] = value_of(name, value, context)
    return found


def value_of(name: str, value: object, context: LaunchContext) -> object:
    """One value; what substitutions bring is read as YAML, as typed on a command line."""
    if isinstance(value, ParameterValue):
        return value.evaluate(context)
    if has_substitution(value) and _is_text(value):
        return _read(name, as_text(value, context))
    if isinstance(value, _PLAIN):
        return value
    if isinstance(value, (list, tuple)):
        made = (Substitution, list, tuple)  # of substitutions and texts
        return _of_one_type(
            name, [_read(name, as_text(part, context)) if isinstance(part, made) else part for part in value]
        )
    raise LaunchError(f"Parameter '{name}' has the value {value!r}: {_EXPECTED}.")


def _is_text(value: object) -> bool:
    """Whether it becomes one text: a substitution, or a list of substitutions and texts."""
    if isinstance(value, (str, Substitution)):
        return True
    return isinstance(value, (list, tuple)) and all(isinstance(part, (str, Substitution)) for part in value)


def _read(name: str, text: str) -> object:
    """What YAML makes of a text; an empty one stays one."""
    whose = f"Parameter '{name}'" if name else "The parameter"
    as_it_is = "To have the text as it is, write ParameterValue(..., value_type=str)."
    if not text:
        return ""
    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError:
        raise LaunchError(f"{whose} has the value {text!r}, which YAML cannot read. {as_it_is}") from None
    if isinstance(value, list):
        return _of_one_type(name, value)
    if not isinstance(value, _PLAIN):
        raise LaunchError(f"{whose} has the value {text!r}: {_EXPECTED}. {as_it_is}")
    return value


def _of_one_type(name: str, values: list[object]) -> list[object]:
    """The elements of a list; whole numbers among others become floats, as in ROS 2."""
    kinds = {type(value) for value in values}
    if kinds == {int, float}:
        return [float(value) for value in values]  # type: ignore[arg-type]
    if not values:
        raise LaunchError(f"Parameter '{name}' is an empty list, whose type ROS 2 cannot know: leave it out.")
    if len(kinds) > 1 or not kinds <= set(_PLAIN):
        raise LaunchError(f"Parameter '{name}' has the value {values!r}: all elements of a list have one type.")
    return values


def _convert_value(value: object, kind: type) -> object:
    if kind is bool or isinstance(value, bool):
        if kind is bool and isinstance(value, bool):
            return value
        raise TypeError
    if kind is int and isinstance(value, float):
        raise TypeError
    if kind is str:
        return str(value)
    return kind(value)


@dataclass
class ProcessDescription:
    """A process of a launch."""

    action: Action
    command: list[str]
    label: str
    environ: Mapping[str, str]
    show: tuple[bool, bool]
    temporary: list[Path]
    respawn_s: float | None = None  # how long after its end it is started again; never when None


class ExecuteProcess(Action):
    """A program."""

    def __init__(  # noqa: PLR0913 - launch has them
        self,
        *,
        cmd: Iterable[Text],
        name: Text | None = None,
        additional_env: Mapping[Text, Text] | None = None,
        shell: bool = False,
        output: Text = "log",
        on_exit: Reaction = None,
        emulate_tty: object = False,
        respawn: object = False,
        respawn_delay: float | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        del emulate_tty
        self._cmd, self._name, self._shell = list(cmd), name, shell
        self._additional_env, self._output, self._on_exit = dict(additional_env or {}), output, on_exit
        self._respawn, self._respawn_delay = respawn, respawn_delay

    def execute(self, context: LaunchContext) -> None:
        """Start the process; a program that is missing ends nothing but its own part of the launch."""
        if self._on_exit is not None:
            context.service.register(OnProcessExit(target_action=self, on_exit=self._on_exit), context)
        temporary: list[Path] = []
        try:
            command = self.command(context, temporary)
            description = self._describe(context, command, temporary)
            context.service.start(description)
        except ProgramError as error:
            context.service.fail(error.add_place(self.place))

    def command(self, context: LaunchContext, temporary: list[Path]) -> list[str]:
        del temporary
        if self._shell:
            return [*_SHELL, " ".join(as_text(word, context) for word in self._cmd)]
        words: list[str] = []
        for word in self._cmd:  # a program in Python is several words: the interpreter, and what it runs
            words += word.find_words(context) if isinstance(word, ExecutableInPackage) else [as_text(word, context)]
        if words and words[0] in _PYTHONS:
            words[0] = sys.executable  # the one with rclpy
        return words

    def label(self, context: LaunchContext, command: list[str]) -> str:
        if self._name is not None:
            return as_text(self._name, context)
        if self._cmd and isinstance(self._cmd[0], ExecutableInPackage):
            return Path(self._cmd[0].name(context)).name
        words = command[-1].split() if self._shell else command
        return Path(words[0] if words else "process").name

    def sub_entities(self) -> list[object]:
        return [] if callable(self._on_exit) else as_entities(self._on_exit)

    def _describe(self, context: LaunchContext, command: list[str], temporary: list[Path]) -> ProcessDescription:
        if not command:
            raise LaunchError(f"{type(self).__name__}: the command is empty.")
        output = as_text(self._output, context)
        if output not in _OUTPUTS:
            raise LaunchError(f"output={output!r}: the course kit knows {', '.join(_OUTPUTS)}.")
        again = self._respawn if isinstance(self._respawn, bool) else read_truth(as_text(self._respawn, context))
        more = {as_text(name, context): as_text(value, context) for name, value in self._additional_env.items()}
        environ = {**context.environment, **more}
        return ProcessDescription(
            action=self,
            command=command,
            label=self.label(context, command),
            environ={**environ, "PATH": with_scripts_first(environ.get("PATH"))},
            show=_OUTPUTS[output],
            temporary=temporary,
            respawn_s=float(self._respawn_delay or 0.0) if again else None,
        )


class Node(ExecuteProcess):
    """A node, started as `ros2 run package executable` would."""

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
        **process: Any,
    ) -> None:
        super().__init__(cmd=(), **process)
        self._executable, self._package = executable, package
        self._node_name, self._namespace = name, namespace
        if isinstance(parameters, (str, Mapping)):
            raise LaunchError("Node(parameters=...) is a list: write [ and ] around the dict or the path.")
        self._parameters, self._remappings = list(parameters or []), list(remappings or [])
        self._arguments = list(arguments or [])

    def command(self, context: LaunchContext, temporary: list[Path]) -> list[str]:
        """The program, its arguments, and ROS's arguments."""
        package = None if self._package is None else as_text(self._package, context)
        command = find_command(package, as_text(self._executable, context), [context.file.parent])
        command += [as_text(argument, context) for argument in self._arguments]
        return [*command, "--ros-args", *self._ros_arguments(context, temporary)]

    def label(self, context: LaunchContext, command: list[str]) -> str:
        del command
        return Path(as_text(self._executable, context)).name

    def _ros_arguments(self, context: LaunchContext, temporary: list[Path]) -> list[str]:
        name = None if self._node_name is None else as_text(self._node_name, context)
        own = None if self._namespace is None else as_text(self._namespace, context)
        namespace = join_namespace(context.namespace, own or "")
        arguments = [] if name is None else ["-r", f"__node:={name}"]
        arguments += ["-r", f"__ns:={namespace}"] if namespace else []
        for given, value in context.parameters.items():
            arguments += ["-p", f"{given}:={_write_as_yaml(value)}"]
        whose = f"{namespace.rstrip('/')}/{name}" if name is not None and namespace else "/**"
        for parameters in self._parameters:
            arguments += self._parameter_words(parameters, whose, context, temporary)
        pairs = [(as_text(old, context), as_text(new, context)) for old, new in self._remappings]
        for old, new in pairs:  # of two for one name the first counts
            arguments += ["-r", f"{old}:={new}"]
        return arguments

    def _parameter_words(
        self, parameters: object, whose: str, context: LaunchContext, temporary: list[Path]
    ) -> list[str]:
        if isinstance(parameters, Mapping):
            values = values_of(parameters, context)
            text = yaml.safe_dump({whose: {"ros__parameters": values}}, default_flow_style=False)
            with tempfile.NamedTemporaryFile("w", prefix="launch_params_", encoding="utf-8", delete=False) as file:
                file.write(text)
            temporary.append(Path(file.name))
            return ["--params-file", file.name]
        if isinstance(parameters, (str, PurePath, Substitution, list, tuple)):
            path = context.file.parent / as_text(parameters, context)
            if path.is_file():
                return ["--params-file", str(path)]
            context.service.say(
                f"[WARNING] [launch]: {self.place}: there is no parameter file {path}; the node starts without it."
            )
            return []
        raise LaunchError(f"Node(parameters=[{parameters!r}]): expected a dict of values or the path of a file.")


def join_namespace(outer: str, inner: str) -> str:
    """A namespace within another, absolute, or ""."""
    if inner.startswith("/"):
        return inner
    joined = "/".join(part for part in (outer.strip("/"), inner.strip("/")) if part)
    return f"/{joined}" if joined else ""


def _write_as_yaml(value: object) -> str:
    """A value as `-p name:=value` wants it."""
    return yaml.safe_dump(value, default_flow_style=True).removesuffix("...\n").strip()

"""`launch.actions.ExecuteProcess`: any program as a part of a launch."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from course_kit.environment.search_path import with_scripts_first
from course_kit.launch.action import Action, as_entities
from course_kit.launch.errors import LaunchError, ProgramError
from course_kit.launch.events import OnProcessExit, Reaction
from course_kit.launch.expressions import ExecutableInPackage
from course_kit.launch.process import OUTPUTS, ProcessDescription
from course_kit.launch.substitutions import Text, as_text, truth

if TYPE_CHECKING:
    from collections.abc import Iterable

    from course_kit.launch.context import LaunchContext
    from course_kit.launch.substitutions import Condition

_SHELL = ("/bin/sh", "-c")
_PYTHONS = ("python", "python3")


class ExecuteProcess(Action):
    """A program."""

    OUTSIDE: ClassVar[frozenset[str]] = frozenset(
        {"cached_output", "output_format", "prefix", "log_cmd", "sigterm_timeout", "sigkill_timeout"}
        | {"respawn_max_retries"}
    )

    def __init__(  # noqa: PLR0913 - launch has them
        self,
        *,
        cmd: Iterable[Text],
        name: Text | None = None,
        cwd: Text | None = None,
        env: Mapping[Text, Text] | None = None,
        additional_env: Mapping[Text, Text] | None = None,
        shell: bool = False,
        output: Text | Mapping[str, str] = "log",
        on_exit: Reaction = None,
        respawn: Text | bool = False,
        respawn_delay: float | None = None,
        emulate_tty: object = False,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        del emulate_tty
        self._cmd, self._name, self._cwd, self._shell = list(cmd), name, cwd, shell
        self._env, self._additional_env = env, additional_env
        self._output = output
        self._respawn, self._delay = respawn, respawn_delay or 0.0
        self._on_exit = on_exit

    def execute(self, context: LaunchContext) -> None:
        """Start the process; a program that is missing ends nothing but its own part of the launch."""
        if self._on_exit is not None:
            context.service.register(OnProcessExit(target_action=self, on_exit=self._on_exit), context)
        temporary: list[Path] = []
        try:
            command = self.command(context, temporary)
            description = self._described(context, command, temporary)
            context.service.start(description)
        except ProgramError as error:
            context.service.fail(error.at(self.place))

    def command(self, context: LaunchContext, temporary: list[Path]) -> list[str]:
        """The words of the command."""
        del temporary
        if self._shell:
            return [*_SHELL, " ".join(as_text(word, context) for word in self._cmd)]
        words: list[str] = []
        for word in self._cmd:  # a program in Python is several words: the interpreter, and what it runs
            words += word.words(context) if isinstance(word, ExecutableInPackage) else [as_text(word, context)]
        if words and words[0] in _PYTHONS:
            words[0] = sys.executable  # the one with rclpy
        return words

    def label(self, context: LaunchContext, command: list[str]) -> str:
        """What the lines of the process begin with."""
        if self._name is not None:
            return as_text(self._name, context)
        if self._cmd and isinstance(self._cmd[0], ExecutableInPackage):
            return Path(self._cmd[0].name(context)).name
        words = command[-1].split() if self._shell else command
        return Path(words[0] if words else "process").name

    def sub_entities(self) -> list[object]:
        """The actions for its end."""
        return [] if callable(self._on_exit) else as_entities(self._on_exit)

    def _described(self, context: LaunchContext, command: list[str], temporary: list[Path]) -> ProcessDescription:
        if not command:
            raise LaunchError(f"{type(self).__name__}: the command is empty.")
        label = self.label(context, command)
        return ProcessDescription(
            action=self,
            command=command,
            label=label,
            environ=self._environ(context),
            folder=None if self._cwd is None else as_text(self._cwd, context),
            show=_shown(self._output, context),
            temporary=temporary,
            respawn=truth(str(self._respawn) if isinstance(self._respawn, bool) else self._respawn, context),
            respawn_delay_s=self._delay,
        )

    def _environ(self, context: LaunchContext) -> dict[str, str]:
        environ = dict(context.environment) if self._env is None else _texts(self._env, context)
        environ |= _texts(self._additional_env or {}, context)
        environ["PATH"] = with_scripts_first(environ.get("PATH"))
        return environ


def _texts(values: Mapping[Any, Any], context: LaunchContext) -> dict[str, str]:
    return {as_text(name, context): as_text(value, context) for name, value in values.items()}


def _shown(output: Text | Mapping[str, str], context: LaunchContext) -> tuple[bool, bool]:
    """Whether stdout, and stderr, are shown."""
    if isinstance(output, Mapping):
        both = output.get("both", "log")
        first, second = (output.get(stream, both) for stream in ("stdout", "stderr"))
        return "screen" in first, "screen" in second
    word = as_text(output, context)
    if word not in OUTPUTS:
        raise LaunchError(f"output={word!r}: the course kit knows {', '.join(OUTPUTS)}.")
    return OUTPUTS[word]

"""Values that are known only when the launch file runs ("Using substitutions" among the ROS 2 tutorials)."""

from __future__ import annotations

import math
import shlex
import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path, PurePath
from typing import Union

from course_kit.environment.paths import with_scripts_first
from course_kit.launch.entity import LaunchContext, LaunchEntity
from course_kit.launch.errors import LaunchError
from course_kit.launch.executables import find_command
from course_kit.launch.package_index import prefix_of
from course_kit.ros.names import did_you_mean

_COMMAND_S = 60.0  # a launch file that asks a program waits for its answer
_WORDS = {"true": True, "1": True, "false": False, "0": False}


class Substitution(LaunchEntity):
    """Something that becomes text."""

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        raise NotImplementedError(type(self).__name__)

    def describe(self) -> str:
        return f"{type(self).__name__}({', '.join(map(describe_text, self.given))})"


Text = Union[str, PurePath, Substitution, Iterable[object]]  # noqa: UP007 - evaluated at run time on Python 3.10, too


class TextSubstitution(Substitution):
    """Fixed text."""

    def __init__(self, *, text: str) -> None:
        self.text = text

    def perform(self, context: LaunchContext) -> str:
        del context
        return self.text

    def describe(self) -> str:
        return repr(self.text)


class LaunchConfiguration(Substitution):
    """The value of a launch argument."""

    def __init__(self, variable_name: Text, *, default: Text | None = None) -> None:
        self._name, self._default = variable_name, default

    def perform(self, context: LaunchContext) -> str:
        """The value; a LaunchError if it has none."""
        name = as_text(self._name, context)
        if name in context.launch_configurations:
            return context.launch_configurations[name]
        if self._default is None:
            raise LaunchError(
                f"LaunchConfiguration('{name}') has no value: no DeclareLaunchArgument('{name}') stands before it, and "
                f"the command line has no {name}:=value.{did_you_mean(name, sorted(context.launch_configurations))}"
            )
        return as_text(self._default, context)


class PathJoinSubstitution(Substitution):
    """Parts joined to a path."""

    def __init__(self, substitutions: Iterable[Text]) -> None:
        self._parts = list(substitutions)

    def perform(self, context: LaunchContext) -> str:
        return str(PurePath(*(as_text(part, context) for part in self._parts)))


class EnvironmentVariable(Substitution):
    """The value of an environment variable."""

    def __init__(self, name: Text, *, default_value: Text | None = None) -> None:
        self._name, self._default = name, default_value

    def perform(self, context: LaunchContext) -> str:
        name = as_text(self._name, context)
        if name in context.environment:
            return context.environment[name]
        if self._default is None:
            raise LaunchError(f"The environment variable {name} is not set, and no default_value is given.")
        return as_text(self._default, context)


class FindExecutable(Substitution):
    """The path of a program on PATH."""

    def __init__(self, *, name: Text) -> None:
        self._name = name

    def perform(self, context: LaunchContext) -> str:
        name = as_text(self._name, context)
        found = shutil.which(name, path=with_scripts_first(context.environment.get("PATH")))
        if found is None:
            raise LaunchError(f"There is no program {name} on PATH.")
        return found


class Command(Substitution):
    """What a program prints."""

    def __init__(self, command: Text) -> None:
        self._command = command

    def perform(self, context: LaunchContext) -> str:
        command = as_text(self._command, context)
        try:
            done = subprocess.run(
                shlex.split(command),
                env=context.environment,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=_COMMAND_S,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise LaunchError(f"Command({command!r}) has not ended within {_COMMAND_S:.0f} s.") from None
        except OSError as error:
            raise LaunchError(f"Command({command!r}) cannot be run: {error.strerror}.") from None
        errors = done.stderr.strip()
        if done.returncode:
            raise LaunchError(f"Command({command!r}) failed with exit code {done.returncode}. {errors}".strip())
        if errors:
            raise LaunchError(f"Command({command!r}) wrote to stderr: {errors}")
        return done.stdout


class PythonExpression(Substitution):
    """The value of a Python expression."""

    def __init__(self, expression: Text) -> None:
        self._expression = expression

    def perform(self, context: LaunchContext) -> str:
        """The value, as text."""
        expression = as_text(self._expression, context)
        try:
            return str(eval(expression, {}, {"math": math, **vars(math)}))  # noqa: S307 - by the author of the launch file
        except Exception as error:  # noqa: BLE001 - whatever an expression raises
            raise LaunchError(f"PythonExpression({expression!r}): {type(error).__name__}: {error}") from None


class FindPackageShare(Substitution):
    """The share folder of a package."""

    def __init__(self, package: Text) -> None:
        self._package = package

    def perform(self, context: LaunchContext) -> str:
        name = as_text(self._package, context)
        return str(Path(prefix_of(name), "share", name))

    def find(self, package_name: Text) -> str:
        """The folder for a package, as launch files ask for it that need it before they run."""
        return type(self)(package_name).perform(LaunchContext())


class ExecutableInPackage(Substitution):
    """The program of a package, as a path."""

    def __init__(self, executable: Text, package: Text) -> None:
        self._executable, self._package = executable, package

    def name(self, context: LaunchContext) -> str:
        return as_text(self._executable, context)

    def find_words(self, context: LaunchContext) -> list[str]:
        near = [context.file.parent]
        return find_command(as_text(self._package, context), as_text(self._executable, context), near)

    def perform(self, context: LaunchContext) -> str:
        """The path, or the command where a program has none."""
        return shlex.join(self.find_words(context))


def as_text(value: object, context: LaunchContext) -> str:
    """Text, a substitution, or a list of both, as text."""
    if isinstance(value, Substitution):
        try:
            return value.perform(context)
        except LaunchError as error:
            raise error.add_place(value.place) from None
    if isinstance(value, (list, tuple)):
        return "".join(as_text(part, context) for part in value)
    if isinstance(value, bool):
        return str(value).lower()
    return str(value)


def has_substitution(value: object) -> bool:
    """Whether a value is only known when the file runs."""
    return isinstance(value, Substitution) or (
        isinstance(value, (list, tuple)) and any(isinstance(part, Substitution) for part in value)
    )


def describe_text(value: object) -> str:
    """How a text is written, for `--show-args`."""
    if isinstance(value, Substitution):
        return value.describe()
    if isinstance(value, (list, tuple)):
        return " + ".join(describe_text(part) for part in value)
    return repr(str(value))


class Condition(LaunchEntity):
    """What an action depends on."""

    def evaluate(self, context: LaunchContext) -> bool:
        """Whether it holds now."""
        raise NotImplementedError(type(self).__name__)


def read_truth(text: str, place: str = "") -> bool:
    """What a text means as a condition."""
    if text.strip().lower() not in _WORDS:
        raise LaunchError(f"A condition is true or false, and {text.strip()!r} is neither.", place)
    return _WORDS[text.strip().lower()]


class IfCondition(Condition):
    """Holds for "true" and "1", in any case of letters."""

    def __init__(self, predicate_expression: Text) -> None:
        self._expression = predicate_expression

    def evaluate(self, context: LaunchContext) -> bool:
        return read_truth(as_text(self._expression, context), self.place)


class UnlessCondition(IfCondition):
    """Holds for "false" and "0", in any case of letters."""

    def evaluate(self, context: LaunchContext) -> bool:
        return not super().evaluate(context)


class LaunchConfigurationEquals(Condition):
    """Holds when a launch argument has a value."""

    def __init__(self, launch_configuration_name: str, expected_value: Text | None) -> None:
        self._name, self._expected = launch_configuration_name, expected_value

    def evaluate(self, context: LaunchContext) -> bool:
        expected = None if self._expected is None else as_text(self._expected, context)
        return context.launch_configurations.get(self._name) == expected

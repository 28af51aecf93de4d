"""Substitutions that ask the machine, or compute: variables, programs, packages, expressions."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.environment.search_path import with_scripts_first
from course_kit.launch.context import LaunchContext
from course_kit.launch.errors import LaunchError
from course_kit.launch.executables import find
from course_kit.launch.package_index import prefix_of
from course_kit.launch.substitutions import (
    LaunchConfiguration,
    Substitution,
    Text,
    ThisLaunchFileDir,
    as_text,
    described,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


_COMMAND_S = 60.0  # a launch file that asks a program waits for its answer


class EnvironmentVariable(Substitution):
    """The value of an environment variable."""

    def __init__(self, name: Text, *, default_value: Text | None = None) -> None:
        self._name, self._default = name, default_value

    def perform(self, context: LaunchContext) -> str:
        """The value."""
        name = as_text(self._name, context)
        if name in context.environment:
            return context.environment[name]
        if self._default is None:
            raise LaunchError(f"The environment variable {name} is not set, and no default_value is given.")
        return as_text(self._default, context)

    def describe(self) -> str:
        """The variable."""
        return f"EnvVar({described(self._name)})"


class FindExecutable(Substitution):
    """The path of a program on PATH."""

    def __init__(self, *, name: Text) -> None:
        self._name = name

    def perform(self, context: LaunchContext) -> str:
        """The path."""
        name = as_text(self._name, context)
        found = shutil.which(name, path=with_scripts_first(context.environment.get("PATH")))
        if found is None:
            raise LaunchError(f"There is no program {name} on PATH.")
        return found

    def describe(self) -> str:
        """The program."""
        return f"FindExec({described(self._name)})"


class Command(Substitution):
    """What a program prints."""

    def __init__(self, command: Text, *, on_stderr: Text = "fail") -> None:
        self._command, self._on_stderr = command, on_stderr

    def perform(self, context: LaunchContext) -> str:
        """What it prints."""
        command, on_stderr = as_text(self._command, context), as_text(self._on_stderr, context)
        try:
            done = subprocess.run(
                shlex.split(command),
                env=context.environment,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT if on_stderr == "capture" else subprocess.PIPE,
                text=True,
                errors="replace",
                timeout=_COMMAND_S,
                check=False,
            )
        except subprocess.TimeoutExpired:
            raise LaunchError(f"Command({command!r}) has not ended within {_COMMAND_S:.0f} s.") from None
        except (OSError, ValueError) as error:
            why = error.strerror if isinstance(error, OSError) else error
            raise LaunchError(f"Command({command!r}) cannot be run: {why}.") from None
        said = (done.stderr or "").strip()
        if done.returncode:
            raise LaunchError(f"Command({command!r}) failed with exit code {done.returncode}. {said}".strip())
        if said and on_stderr == "fail":
            raise LaunchError(f"Command({command!r}) wrote to stderr: {said}")
        if said and on_stderr == "warn" and context.running is not None:
            context.running.say(f"[WARNING] [launch]: {command!r} wrote to stderr: {said}")
        return done.stdout

    def describe(self) -> str:
        """The command."""
        return f"Command({described(self._command)})"


class PythonExpression(Substitution):
    """The value of a Python expression."""

    def __init__(self, expression: Text, python_modules: Iterable[Text] = ("math",)) -> None:
        self._expression, self._modules = expression, python_modules

    def perform(self, context: LaunchContext) -> str:
        """The value, as text."""
        expression = as_text(self._expression, context)
        modules = [self._modules] if isinstance(self._modules, str) else list(self._modules)
        names: dict[str, object] = {}
        try:
            for name in (as_text(module, context) for module in modules):
                names[name] = import_module(name)
                names |= vars(names[name]) if name == "math" else {}
            return str(eval(expression, {}, names))  # noqa: S307 - the launch file is a program of the same author
        except Exception as error:  # noqa: BLE001 - whatever an expression raises
            raise LaunchError(f"PythonExpression({expression!r}): {type(error).__name__}: {error}") from None

    def describe(self) -> str:
        """The expression."""
        return f"PythonExpr({described(self._expression)})"


class FindPackageShare(Substitution):
    """The share folder of a package."""

    def __init__(self, package: Text) -> None:
        self._package = package

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        name = as_text(self._package, context)
        return str(Path(FindPackagePrefix(name).perform(context), "share", name))

    def find(self, package_name: Text) -> str:
        """The folder for a package, as launch files ask for it that need it before they run."""
        return type(self)(package_name).perform(LaunchContext())

    def describe(self) -> str:
        """The package."""
        return f"{type(self).__name__}(pkg={described(self._package)})"


class FindPackagePrefix(FindPackageShare):
    """The folder that a package is installed in."""

    def perform(self, context: LaunchContext) -> str:
        """The folder."""
        return prefix_of(as_text(self._package, context))


class ExecutableInPackage(Substitution):
    """The program of a package, as a path."""

    def __init__(self, executable: Text, package: Text) -> None:
        self._executable, self._package = executable, package

    def name(self, context: LaunchContext) -> str:
        """What the program is called."""
        return as_text(self._executable, context)

    def words(self, context: LaunchContext) -> list[str]:
        """The words of its command."""
        near = [context.file.parent]
        return find(as_text(self._package, context), as_text(self._executable, context), near)

    def perform(self, context: LaunchContext) -> str:
        """The path, or the command where a program has none of its own."""
        return shlex.join(self.words(context))


_SUBSTITUTION = re.compile(r"\$\((?P<kind>[\w-]+)(?P<rest>[^()$]*)\)")  # one without another one in it
_IN_TEXT: dict[str, Callable[..., Substitution]] = {
    "command": Command,
    "dirname": ThisLaunchFileDir,
    "env": lambda name, default=None: EnvironmentVariable(name, default_value=default),
    "eval": PythonExpression,
    "find-exec": lambda name: FindExecutable(name=name),
    "find-pkg-prefix": FindPackagePrefix,
    "find-pkg-share": FindPackageShare,
    "var": lambda name, default=None: LaunchConfiguration(name, default=default),
}


def replace_substitutions(text: str, context: LaunchContext) -> str:
    """A text in which `$(var name)` and the like are replaced, the inner ones first."""

    def replaced(found: re.Match[str]) -> str:
        kind, words = found["kind"], shlex.split(found["rest"])
        try:
            return _IN_TEXT[kind](*words).perform(context)
        except KeyError:
            known = ", ".join(f"$({name} ...)" for name in _IN_TEXT)
            raise LaunchError(f"{found[0]} is not part of the course kit's launch files, which know {known}.") from None
        except TypeError:
            raise LaunchError(f"{found[0]}: $({kind} ...) takes another number of words.") from None

    while (after := _SUBSTITUTION.sub(replaced, text)) != text:
        text = after
    return text

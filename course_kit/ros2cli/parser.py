"""The command line: commands, their verbs, and errors that name the nearest right word."""

from __future__ import annotations

import argparse
import os
import re
import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any, NoReturn

from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.ros2cli.session import Session

    Verbs = argparse._SubParsersAction[argparse.ArgumentParser]  # noqa: SLF001 - what `add_subparsers` returns
    Run = Callable[[argparse.Namespace, Session], int | None]  # the exit code; None for 0

COMMANDS = {
    "action": "list actions, send goals",
    "daemon": "the process that knows the graph: start, stop, status",
    "doctor": "check the machine, the packages and the graph",
    "interface": "show the text of messages, services and actions",
    "launch": "run a launch file",
    "node": "list nodes, see what they have",
    "param": "list, get, set and save parameters of nodes",
    "pkg": "packages and their programs",
    "run": "run a node by package and executable",
    "service": "list services, call them",
    "topic": "list topics, listen, publish",
    "wtf": "the same as doctor",
}
_MODULES = {"wtf": "doctor", "daemon": "doctor", "run": "pkg"}  # commands in the module of a different one
# What the real command has besides; empty for the commands themselves.
_ONLY_IN_ROS = {
    "": "bag component control extensions lifecycle multicast plugin security test",
    "pkg": "create xml",
    "doctor": "hello",
}
_OPTIONS_ONLY_IN_ROS = {
    "doctor": "-r --report -rf --report-failed -ep --exclude-packages",
    "launch": "-d --debug -p --print -a --show-all-subprocesses-output --launch-prefix --launch-prefix-filter",
    "topic": "--qos-liveliness --qos-liveliness-lease-duration-seconds",
}
_INSTEAD = {"create": "a folder with your program in it is enough: `ros2 run` finds it"}
DEFAULT_TIMEOUT = 10.0
_HELP_WIDTH = 100
_SUBSET = (
    "The ros2 command of the ROS 2 course kit: a subset of the real one, against the nodes of the course. "
    "A command waits --timeout seconds at most; only one that listens to messages goes on until you stop it."
)
_BAD_CHOICE = re.compile(r"invalid choice: '(?P<word>[^']*)' \(choose from (?P<choices>.*)\)")


class _Help(argparse.HelpFormatter):
    """Help in the terminal's width, which a command that prints no help need not find out."""

    def __init__(self, prog: str) -> None:
        columns = os.environ.get("COLUMNS", "")
        width = int(columns) if columns.isdecimal() else 0
        super().__init__(prog, width=width or _HELP_WIDTH, max_help_position=32)

    def add_argument(self, action: argparse.Action) -> None:
        """Add an argument to the help, and see how much room its name takes."""
        super().add_argument(action)
        for verb in self._iter_indented_subactions(action):
            length = self._current_indent + len(self._format_action_invocation(verb))
            self._action_max_length = max(self._action_max_length, length)

    def _format_action_invocation(self, action: argparse.Action) -> str:
        if not action.option_strings or action.nargs == 0:
            return super()._format_action_invocation(action)
        value = self._format_args(action, action.dest.upper())
        return f"{', '.join(action.option_strings)} {value}"


class Parser(argparse.ArgumentParser):
    """An ArgumentParser whose errors are one line."""

    command = ""  # of the words being read

    def __init__(self, **options: Any) -> None:
        if sys.version_info >= (3, 14):
            options = {"color": False, **options}
        super().__init__(**{"formatter_class": _Help, **options})

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and which word is nearest; exit code 2 as everywhere with argparse."""
        if wrong := _BAD_CHOICE.search(message):
            choices = re.findall(r"[\w.-]+", wrong["choices"])
            if wrong["word"] in _ONLY_IN_ROS.get(self.prog.removeprefix("ros2").strip(), "").split():
                instead = _INSTEAD.get(wrong["word"])
                end = f"; {instead}." if instead else ". It is in a full installation of ROS 2."
                sys.stderr.write(f"{self.prog}: '{wrong['word']}' exists in ROS 2; this course does not have it{end}\n")
                raise SystemExit(2)
            near = did_you_mean(wrong["word"], choices) or f" Choose one of: {', '.join(choices)}."
            message = f"{message[: wrong.start()]}there is no {wrong['word']!r}.{near}"
        elif unknown := re.fullmatch(r"unrecognized arguments: (.*)", message):
            message = _explain_unknown_words(self.command, unknown[1])
        sys.stderr.write(f"{self.prog}: {message}\n")
        raise SystemExit(2)


def _explain_unknown_words(command: str, words: str) -> str:
    """What to say of words that nobody takes."""
    if "}" in words or "{" in words or re.match(r"\w+:[^=]", words):  # {a:1,b:2} becomes a:1 b:2
        return f"the shell has taken the values apart (left over: {words}): put '...' around {{...}}"
    option = words.split(maxsplit=1)[0].partition("=")[0]
    if option in _OPTIONS_ONLY_IN_ROS.get(command, "").split():
        return f"{option} exists in ROS 2; this course does not have it. It is in a full installation of ROS 2."
    return f"unknown: {words} (--help shows what there is)"


def command_parser(arguments: Sequence[str]) -> Parser:
    """A parser for these arguments, with only the verbs of the command that is meant; all when none is."""
    named = next((word for word in arguments if not word.startswith("-")), None)
    parser = build_parser([named] if named in COMMANDS else [])
    parser.command = named or ""
    return parser


def build_parser(commands: Sequence[str]) -> Parser:
    """A parser that knows all commands by name, and the verbs of `commands`."""
    parser = Parser(prog="ros2", description=_SUBSET)
    places = parser.add_subparsers(metavar="command", title="commands", parser_class=Parser)
    for name, purpose in COMMANDS.items():
        place = places.add_parser(name, help=purpose, description=f"{purpose}. {_SUBSET}")
        place.set_defaults(parser=place, on_graph=name not in {"interface", "pkg"})
        if name in commands:
            module = import_module(f"course_kit.ros2cli.verbs.{_MODULES.get(name, name)}")  # of what is meant alone
            getattr(module, f"add_{name}_to", module.add_to)(place)
    return parser


def add_verbs(place: argparse.ArgumentParser) -> Verbs:
    """Where the verbs of a command are added; `add_verb` does it."""
    return place.add_subparsers(metavar="verb", title="verbs", parser_class=Parser)


def add_verb(verbs: Verbs, name: str, run: Run, purpose: str) -> argparse.ArgumentParser:
    """One verb, run by `run(options, session)`."""
    verb = verbs.add_parser(name, help=purpose, description=purpose)
    verb.set_defaults(run=run, verb=name)
    return verb


def add_timeout(
    verb: argparse.ArgumentParser,
    purpose: str = "seconds to wait at most",
    default: float | None = DEFAULT_TIMEOUT,
) -> None:
    """The option that keeps a verb from waiting for ever."""
    usual = "no end" if default is None else f"{default:g}"
    verb.add_argument(
        "--timeout", type=_seconds, default=default, metavar="SECONDS", help=f"{purpose} (default: {usual})"
    )


def add_values(verb: argparse.ArgumentParser, name: str, purpose: str) -> None:
    """The fields of a message, typed or from standard input."""
    what = verb.add_mutually_exclusive_group()
    what.add_argument(name, nargs="?", help=purpose)
    what.add_argument("--stdin", action="store_true", help="read the fields from standard input")


def add_patience(verb: argparse.ArgumentParser) -> None:
    """The options of every verb that listens for as long as something comes."""
    add_timeout(verb, "end after this many seconds without a message", default=None)
    add_node_options(verb)


def add_node_options(verb: argparse.ArgumentParser) -> None:
    """The options of the real command's own node, as far as they are without effect here."""
    verb.add_argument("--spin-time", type=_seconds, metavar="SECONDS", help=argparse.SUPPRESS)
    verb.add_argument("--no-daemon", action="store_true", help=argparse.SUPPRESS)
    verb.add_argument("-s", "--use-sim-time", action="store_true", help=argparse.SUPPRESS)


def add_graph_options(verb: argparse.ArgumentParser) -> None:
    """The options of every verb that reads the graph."""
    add_timeout(verb, "seconds to wait at most until the graph is complete")
    verb.add_argument("--no-daemon", action="store_true", help="look at the graph without asking the daemon")
    verb.add_argument("--spin-time", type=_seconds, metavar="SECONDS", help="no effect: every command waits anyway")
    verb.add_argument("-s", "--use-sim-time", action="store_true", help=argparse.SUPPRESS)


def add_named(verb: argparse.ArgumentParser, name: str, completer: str, **options: Any) -> None:
    """A positional argument that the shell completes with `completer`, by the names in `completion`."""
    argument: Any = verb.add_argument(name, **options)
    argument.completer = _Completer(completer)


class _Completer:
    """Finds what may stand here only when a shell asks."""

    def __init__(self, wanted: str) -> None:
        self._wanted = wanted

    def __call__(self, *, parsed_args: argparse.Namespace, prefix: str, **about: object) -> list[str]:
        from course_kit import environment
        from course_kit.ros2cli import completion

        del about
        try:
            return completion.list_candidates(self._wanted, parsed_args, prefix)
        except environment.DomainError:  # the command itself says so
            return []


def _seconds(text: str) -> float:
    value = float(text)
    if not value > 0:
        raise argparse.ArgumentTypeError(f"{text} is not a number of seconds above 0")
    return value

"""`ros2`: finds the verb, runs it, and turns what goes wrong into one line and an exit code.

Only what the verb needs is imported: the start-up is most of what a short command takes.
"""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, NoReturn

from course_kit.ros2cli.errors import CommandError
from course_kit.ros2cli.parser import COMMANDS, build, command_parser

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Sequence

    from rclpy.context import Context
    from rclpy.node import Node

INTERRUPTED = 2  # what the real command ends with after a Ctrl-C


def main() -> None:
    """The `ros2` script: the real command where one is installed, else the course kit's."""
    if "_ARGCOMPLETE" not in os.environ:
        from course_kit.ros2cli import delegation

        delegation.step_aside()
    leave(run_program())


def leave(code: int) -> NoReturn:
    """End this process at once: its node has left the graph by now, and Python would take longer to put itself away."""
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except OSError:  # Python says what is wrong with them
        sys.exit(code)
    os._exit(code)


def run_program() -> int:
    """Run the course kit's own command in a process of its own, with the words it was called with; the exit code."""
    if "_ARGCOMPLETE" not in os.environ:
        from course_kit import environment

        environment.heed_interrupts()  # as programs with rclpy do
    return run(sys.argv[1:], visits=True)


def run(
    arguments: Sequence[str], context: Context | None = None, guests: set[Node] | None = None, *, visits: bool = False
) -> int:
    """Run one command of the course kit's own."""
    if "_ARGCOMPLETE" in os.environ:
        from course_kit.ros2cli import completion

        completion.complete(build(list(COMMANDS)))
    try:
        parser = command_parser(arguments)
        options = parser.parse_args(list(arguments))
        if not hasattr(options, "run"):
            (getattr(options, "parser", None) or parser).print_help()
            return 0
        return _run_verb(options, context, guests, visits=visits)
    except CommandError as error:
        _print_error(str(error))
        return error.exit_code
    except SystemExit as leaving:  # argparse, which has said why
        return leaving.code if isinstance(leaving.code, int) else 1
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:  # `ros2 topic echo /chatter | head`: the reader has seen enough
        _silence_stdout()
        return 0


def _run_verb(options: Namespace, context: Context | None, guests: set[Node] | None, *, visits: bool) -> int:
    from course_kit import environment
    from course_kit.ros2cli.session import Session

    session = Session(context, guests, visits=visits)
    try:
        if options.on_graph:
            environment.apply()  # first: the import of rclpy would print a problem with the domain once more
        code: int | None = options.run(options, session)
        sys.stdout.flush()
    except environment.DomainError as problem:
        raise CommandError(str(problem)) from problem
    else:
        return code or 0
    finally:
        session.close()


def _print_error(line: str) -> None:
    sys.stdout.flush()
    sys.stderr.write(f"{line}\n")


def _silence_stdout() -> None:
    """Python flushes stdout once more at its end, which must not fail again."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, sys.stdout.fileno())
    os.close(null)

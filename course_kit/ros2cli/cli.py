"""`ros2`: finds the verb, runs it, and turns what goes wrong into one line and an exit code.

Only what the verb needs is imported: the start-up is most of what a short command takes.
"""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, NoReturn

from course_kit.ros2cli.parser import COMMANDS, build_parser, command_parser
from course_kit.ros2cli.session import CommandError, Session

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Sequence

    from rclpy.context import Context
    from rclpy.node import Node

_OURS = b"course_kit.ros2cli"  # stands in the script that an installer makes of our entry point
_BOOTSTRAP = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"


def find_real_command() -> str | None:
    """The first `ros2` on PATH that is not the course kit's, or None."""
    for folder in os.get_exec_path():
        candidate = os.path.join(folder, "ros2")  # noqa: PTH118 - pathlib is an import a fast command does without
        if os.path.isfile(candidate) and os.access(candidate, os.X_OK) and not _is_ours(candidate):  # noqa: PTH113
            return candidate
    return None


def clean_environment(environ: dict[str, str]) -> dict[str, str]:
    """`environ` without what the ROS wheels of this Python put there: the real command brings its own libraries."""
    clean = {name: value for name, value in environ.items() if name not in {_BOOTSTRAP, "PYTHONHOME"}}
    ours = os.path.join(sys.prefix, "")  # noqa: PTH118
    for name in ("LD_LIBRARY_PATH", "PYTHONPATH"):
        folders = [folder for folder in clean.get(name, "").split(os.pathsep) if folder and not folder.startswith(ours)]
        clean.pop(name, None)
        if folders:
            clean[name] = os.pathsep.join(folders)
    return clean


def step_aside() -> None:
    """Become the real command, on the course's graph; return if it is not installed."""
    command = find_real_command()
    if command is None:
        return
    from course_kit import environment

    try:
        environment.apply_settings()
    except environment.DomainError as problem:
        sys.stderr.write(f"{problem}\n")
        sys.exit(1)
    sys.stdout.flush()
    os.execve(command, [command, *sys.argv[1:]], clean_environment(dict(os.environ)))


def _is_ours(path: str) -> bool:
    try:
        with open(path, "rb") as script:  # noqa: PTH123
            return _OURS in script.read(2000)
    except OSError:
        return True  # nothing that could be run anyway


INTERRUPTED = 2  # what the real command ends with after a Ctrl-C


def main() -> None:
    """The `ros2` script: the real command where one is installed, else the course kit's."""
    if "_ARGCOMPLETE" not in os.environ:
        step_aside()
    leave_process(run_program())


def leave_process(code: int) -> NoReturn:
    """End this process at once: its node has left the graph by now, and Python would take longer to put itself away."""
    try:
        sys.stdout.flush()
        sys.stderr.flush()
    except OSError:  # Python says what is wrong with them
        sys.exit(code)
    os._exit(code)


def run_program() -> int:
    """Run the course kit's own command in a separate process, with the words it was called with; the exit code."""
    if "_ARGCOMPLETE" not in os.environ:
        from course_kit import environment

        environment.heed_interrupts()  # as programs with rclpy do
    return run_command(sys.argv[1:], visits=True)


def run_command(
    arguments: Sequence[str], context: Context | None = None, guests: set[Node] | None = None, *, visits: bool = False
) -> int:
    """Run one command of the course kit's own."""
    if "_ARGCOMPLETE" in os.environ:
        import argcomplete

        argcomplete.autocomplete(build_parser(list(COMMANDS)), always_complete_options=False)  # does not return
    try:
        parser = command_parser(arguments)
        options = parser.parse_args(list(arguments))
        if not hasattr(options, "run"):
            (getattr(options, "parser", None) or parser).print_help()
            return 0
        return _run_verb(options, context, guests, visits=visits)
    except CommandError as error:
        sys.stdout.flush()
        sys.stderr.write(f"{error}\n")
        return 1
    except SystemExit as leaving:  # argparse, which has said why
        return leaving.code if isinstance(leaving.code, int) else 1
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:  # `ros2 topic echo /chatter | head`: the reader has seen enough
        _silence_stdout()
        return 0


def ros2_line(line: str) -> None:
    """Run `%ros2 service list` and the like in the kernel, in the context of its nodes: all are discovered there."""
    import shlex

    from course_kit import lab
    from course_kit.lab.clients import name_in_conflict

    try:
        words = shlex.split(line)
    except ValueError as error:
        sys.stderr.write(f"%ros2 {line}: {error}.\n")
        return
    engine = lab.current().engine
    try:
        run_command(words, engine.node.context, engine.guests)
    except Exception as error:
        if not (name := name_in_conflict(error)):
            raise
        sys.stderr.write(f"{name} has another type in this notebook, and the two would never meet.\n")


def _run_verb(options: Namespace, context: Context | None, guests: set[Node] | None, *, visits: bool) -> int:
    from course_kit import environment

    session = Session(context, guests, visits=visits)
    try:
        if options.on_graph:
            environment.apply_settings()  # first: the import of rclpy would print a problem with the domain once more
        code: int | None = options.run(options, session)
        sys.stdout.flush()
    except environment.DomainError as problem:
        raise CommandError(str(problem)) from problem
    else:
        return code or 0
    finally:
        session.close()


def _silence_stdout() -> None:
    """Python flushes stdout once more at its end, which must not fail again."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, sys.stdout.fileno())
    os.close(null)

"""`ros2 run`."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.ros2cli.parser import add_named

if TYPE_CHECKING:
    from argparse import Namespace

    from course_kit.ros2cli.session import Session


def add_to(place: argparse.ArgumentParser) -> None:
    """The command has no verbs."""
    place.add_argument("--prefix", default="", help="what to write before the program, such as 'nice -n 5'")
    add_named(place, "package_name", "run_packages", help="the package")
    add_named(place, "executable_name", "run_executables", help="its program, with or without .py")
    place.add_argument("arguments", nargs=argparse.REMAINDER, metavar="...", help="for the program")
    place.set_defaults(run=_run)


def _run(options: Namespace, session: Session) -> int:
    from course_kit import environment
    from course_kit.launch.errors import LaunchError
    from course_kit.launch.executables import find
    from course_kit.launch.package_index import make_known
    from course_kit.ros2cli.errors import CommandError

    make_known([Path.cwd()])
    try:
        program = find(options.package_name, options.executable_name)
    except LaunchError as error:
        raise CommandError(str(error)) from error
    command = [*shlex.split(options.prefix), *program, *options.arguments]
    if session.in_kernel:
        from course_kit.ros2cli.launching import run_and_show

        return run_and_show(command)
    sys.stdout.flush()
    try:
        os.execvpe(command[0], command, environment.child_environment())
    except OSError as error:
        raise CommandError(f"{command[0]}: {error.strerror}.") from error

"""`ros2 pkg`: list, prefix, executables; and `ros2 run`."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.launch import executables
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.parser import add_named, add_verb, add_verbs
from course_kit.ros2cli.session import CommandError, Session

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace


def add_to(place: ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    add_verb(verbs, "list", _list, "List the packages there are")
    prefix = add_verb(verbs, "prefix", _prefix, "Show where a package is")
    add_named(prefix, "package_name", "run_packages")
    prefix.add_argument("--share", action="store_true", help="its share folder")
    programs = add_verb(verbs, "executables", _executables, "List the programs of packages")
    add_named(programs, "package_name", "run_packages", nargs="?", help="of this package alone")
    programs.add_argument("--full-path", action="store_true", help="with the folder of their package")


def _packages() -> list[str]:
    from course_kit import interfaces

    return sorted({*executables.find_packages(), *interfaces.packages()})


def _list(options: Namespace, session: Session) -> None:
    del options, session
    print(*_packages(), sep="\n")


def _prefix(options: Namespace, session: Session) -> None:
    del session
    name = options.package_name
    found = executables.package_prefix(name)
    if found is None:
        raise CommandError(_explain_unknown_package(name))
    print(found / "share" / name if options.share else found)


def _executables(options: Namespace, session: Session) -> None:
    del session
    named = options.package_name
    if named is not None and named not in executables.find_packages() and not executables.list_executables(named):
        raise CommandError(_explain_unknown_package(named))
    for package in executables.find_packages() if named is None else [named]:
        place = executables.package_prefix(package)
        for program in executables.list_executables(package):
            print(f"{place}/{program}" if options.full_path else f"{package} {program}")


def _explain_unknown_package(name: str) -> str:
    if name in _packages():
        return f"Package '{name}' contains only interfaces: it is one of Python's packages and has no programs."
    return f"Package not found: {name}.{did_you_mean(name, _packages())}"


def add_run_to(place: ArgumentParser) -> None:
    """`ros2 run` has no verbs."""
    place.add_argument("--prefix", default="", help="what to write before the program, such as 'nice -n 5'")
    add_named(place, "package_name", "run_packages", help="the package")
    add_named(place, "executable_name", "run_executables", help="its program, with or without .py")
    place.add_argument("arguments", nargs=argparse.REMAINDER, metavar="...", help="for the program")
    place.set_defaults(run=_run)


def _run(options: Namespace, session: Session) -> int:
    from course_kit import environment
    from course_kit.launch.errors import LaunchError
    from course_kit.launch.package_index import make_known

    make_known([Path.cwd()])
    try:
        program = executables.find_command(options.package_name, options.executable_name)
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

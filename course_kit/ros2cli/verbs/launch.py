"""`ros2 launch`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.parser import add_named
from course_kit.ros2cli.session import CommandError, Session

if TYPE_CHECKING:
    from argparse import Namespace


_SEPARATOR = ":="


def add_to(place: argparse.ArgumentParser) -> None:
    """The command has no verbs."""
    place.add_argument("-s", "--show-args", "--show-arguments", action="store_true", help="show the file's arguments")
    place.add_argument("-n", "--noninteractive", action="store_true", help=argparse.SUPPRESS)
    add_named(place, "package_name", "launch_files", help="a launch file, or the package that has it")
    place.add_argument(
        "words", nargs="*", metavar="launch_file_name | name:=value", help="its launch file, and values for arguments"
    )
    place.set_defaults(run=_launch)


def _launch(options: Namespace, session: Session) -> int:
    file, arguments = _file_and_arguments(options.package_name, options.words)
    if session.in_kernel:
        from course_kit.ros2cli.launching import run_and_show

        option = ["--show-args"] if options.show_args else []
        given = [f"{name}{_SEPARATOR}{value}" for name, value in arguments.items()]
        return run_and_show([sys.executable, "-m", "course_kit.ros2cli", "launch", *option, str(file), *given])
    from course_kit.launch import finder
    from course_kit.launch.errors import LaunchError

    finder.come_before_folders()
    try:
        return _run(file, arguments, show=options.show_args)
    except LaunchError as error:
        raise CommandError(f"Launch failed: {error}") from error


def _run(file: Path, arguments: dict[str, str], *, show: bool) -> int:
    if show:
        from course_kit.launch.actions import show_arguments

        print(show_arguments(file))
        return 0
    from course_kit.launch.service import LaunchService, log_file

    with log_file() as log:
        return LaunchService(log).run(file, arguments)


def _file_and_arguments(first: str, words: list[str]) -> tuple[Path, dict[str, str]]:
    """The launch file, and the values given as name:=value."""
    from course_kit.launch.actions import not_an_argument

    pairs = [word.partition(_SEPARATOR) for word in words if _SEPARATOR in word]
    names = [word for word in words if _SEPARATOR not in word]
    arguments = {name: value for name, _, value in pairs}
    path = Path(first)
    if path.is_file():
        if names:
            raise CommandError(not_an_argument(names[0]))
        return path.resolve(), arguments
    if len(names) == 1:
        return _in_package(first, names[0]), arguments
    if names:
        raise CommandError(not_an_argument(names[1]))
    near = [str(found) for found in path.parent.glob("*launch.py")] if path.parent.is_dir() else []
    raise CommandError(f"There is no launch file {first}.{did_you_mean(first, near)}")


def _in_package(package: str, name: str) -> Path:
    from course_kit.launch.executables import explain_missing, package_folders

    known: list[str] = []
    folders = package_folders(package)
    for folder in folders:
        files = [file for place in (folder, folder / "launch") if place.is_dir() for file in place.glob("*launch.py")]
        known += [file.name for file in files]
        for place in (folder, folder / "launch"):
            if (place / name).is_file():
                return (place / name).resolve()
    if not any(folder.is_dir() for folder in folders):
        raise CommandError(explain_missing(package))
    raise CommandError(f"Package '{package}' has no launch file '{name}' here.{did_you_mean(name, known)}")

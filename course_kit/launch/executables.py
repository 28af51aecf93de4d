"""Finds the program for a package and an executable, where there is no workspace that has been built.

Looked for, in this order: what is installed, entry points of an installed Python package, folders called like the
package, and last a script of that name beside the launch file, in the current folder, or of a `%%ros_script` cell.
"""

from __future__ import annotations

import os
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.interfaces.known_types import package_prefixes
from course_kit.launch.errors import ProgramError
from course_kit.launch.package_index import PACKAGE_PATH, is_one, read_programs, sources_near
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_ENDINGS = ("", ".py")
# Packages of compiled programs, or of programs with a window, that many launch files start
_OF_AN_INSTALLATION = re.compile(
    r"(turtlesim|rviz2|rviz_.*|rqt.*|gazebo.*|ros_gz.*|ros_ign.*|webots.*|robot_state_publisher|joint_state_publisher.*|"
    r"controller_manager|nav2_.*|slam_toolbox|cartographer.*|moveit_.*|demo_nodes_cpp|tf2_ros|xacro|teleop_.*|joy.*|"
    r"rclcpp_components|robot_localization|image_.*|v4l2_camera|usb_cam)$"
)
_NO_SOURCES = ("launch", "test", "tests")
_NO_PROGRAMS = (".launch.py", "setup.py", "conftest.py")


def find_command(package: str | None, executable: str, near: Sequence[Path] = ()) -> list[str]:
    """The command that runs an executable; Python scripts run in this Python."""
    if package is None:
        return _program(executable, near)
    folders = list(_folders(near))
    for place in _package_places(package, folders):
        if found := _of_source(place, executable) or _find_in_folder(place, executable):
            return found
    if target := _entry_points(package).get(executable):
        module, _, function = target.partition(":")
        return _call(module, function, executable)
    for folder in folders:
        if found := _find_in_folder(folder, executable):
            return found
    raise _not_found(package, executable, folders)


def find_packages(near: Sequence[Path] = ()) -> list[str]:
    """The packages that have programs, by their folders."""
    found = {entry.name for lib in _lib_folders() if lib.is_dir() for entry in lib.iterdir() if _programs(entry)}
    for folder in _folders(near):
        if is_one(folder):
            found.add(folder.name)
        elif folder.is_dir() and folder not in _courses():  # whose folders are not packages of anybody's
            entries = [*folder.iterdir(), *folder.glob("src/*")]
            found |= {entry.name for entry in entries if not entry.name.startswith(".") and _programs(entry)}
    return sorted(found)


def list_executables(package: str, near: Sequence[Path] = ()) -> list[str]:
    """The programs of a package."""
    places = list(_package_places(package, list(_folders(near))))
    named = {*_entry_points(package), *(name for place in places for name in read_programs(place))}
    return sorted(named or {name for place in places for name in _programs(place)})


def package_prefix(package: str) -> Path | None:
    """Where a package is installed, or lies as source; None when nothing is known of it."""
    for lib in _lib_folders():
        if (lib / package).is_dir() or (lib.parent / "share" / package).is_dir():
            return lib.parent
    if _entry_points(package):
        return Path(sys.prefix)
    places = [place for place in _package_places(package, list(_folders(()))) if place.is_dir()]
    return places[0] if places else None


def _folders(near: Sequence[Path]) -> Iterator[Path]:
    """Where packages and loose scripts are looked for."""
    for folder in near:
        yield folder
        yield folder.parent
    yield Path.cwd()
    yield from (Path(folder) for folder in os.environ.get(PACKAGE_PATH, "").split(os.pathsep) if folder)
    yield environment.run_dir(environment.paths.CELL_PROGRAMS)
    if checkout := environment.checkout_folder():
        yield checkout
    yield from (course / "exercises" for course in _courses())


def _courses() -> list[Path]:
    """The learner's folder, and the course's."""
    return [folder for folder in (environment.learner_folder(), environment.course_files()) if folder is not None]


def _lib_folders() -> list[Path]:
    return [Path(prefix, "lib") for prefix in package_prefixes()]


def _package_places(package: str, folders: list[Path]) -> Iterator[Path]:
    for lib in _lib_folders():
        yield lib / package
    for folder in folders:
        if folder.name == package:
            yield folder
        yield folder / package
        yield folder / package / package
        yield folder / package / "scripts"
        yield folder / "src" / package
    if source := sources_near(folders[:1]).get(package):
        yield source
        yield source / package
        yield from sorted(entry for entry in source.iterdir() if entry.is_dir() and entry.name not in _NO_SOURCES)


def _find_in_folder(folder: Path, executable: str) -> list[str] | None:
    for ending in _ENDINGS:
        path = folder / f"{executable}{ending}"
        if path.is_file() and (path.suffix == ".py" or os.access(path, os.X_OK)):
            return _command(path)
    return None


def _of_source(folder: Path, executable: str) -> list[str] | None:
    """The command for a program that the package in a folder names in its setup.py."""
    target = read_programs(folder).get(executable) if is_one(folder) else None
    return None if target is None else _call(*target, executable, folder)


def _call(module: str, function: str, executable: str, folder: Path | None = None) -> list[str]:
    place = "" if folder is None else f"sys.path.insert(0, {str(folder)!r}); "
    code = f"import sys; {place}from {module} import {function}; sys.argv[0] = {executable!r}; sys.exit({function}())"
    return [sys.executable, "-c", code]


def _command(path: Path) -> list[str]:
    return [sys.executable, str(path)] if path.suffix == ".py" else [str(path)]


def _program(executable: str, near: Sequence[Path]) -> list[str]:
    from shutil import which

    for folder in (*near, Path.cwd()):
        path = folder / executable
        if path.is_file():
            return _command(path)
    if found := which(executable):
        return [found]
    raise ProgramError(f"There is no program {executable}.")


def _programs(folder: Path) -> list[str]:
    """The names of what can be run in a folder; none when it is no folder."""
    if not folder.is_dir():
        return []
    files = [path for path in folder.iterdir() if path.is_file() and not path.name.startswith(("_", "."))]
    named = read_programs(folder)
    scripts = [path.stem for path in files if path.suffix == ".py" and not path.name.endswith(_NO_PROGRAMS)]
    return list(named) + scripts + [path.name for path in files if not path.suffix and os.access(path, os.X_OK)]


def _entry_points(package: str) -> dict[str, str]:
    from importlib.metadata import PackageNotFoundError, distribution

    try:
        points = distribution(package).entry_points
    except (PackageNotFoundError, ValueError):
        return {}
    return {point.name: point.value for point in points if point.group == "console_scripts"}


def _not_found(package: str, executable: str, folders: list[Path]) -> ProgramError:
    known = list_executables(package, folders)
    if known:
        hint = did_you_mean(executable, known) or f" It has {', '.join(known)}."
        return ProgramError(f"No executable found: package '{package}' has no '{executable}'.{hint}")
    if _OF_AN_INSTALLATION.match(package):
        return ProgramError(explain_missing(package))
    if source := sources_near(folders[:1]).get(package):
        return ProgramError(
            f"Package '{package}' has no Python program '{executable}' in {source}. A compiled one needs a full ROS 2 "
            "installation."
        )
    hint = did_you_mean(package, find_packages(folders))
    places = ", ".join(dict.fromkeys(str(folder) for folder in folders[:3]))
    return ProgramError(
        f"Package '{package}' not found, nor a script {executable}.py in {places}. {hint.strip()}".rstrip()
    )


def explain_missing(package: str) -> str:
    """What to say of a package of which nothing is there."""
    if _OF_AN_INSTALLATION.match(package):
        return f"Package '{package}' not found: it comes with a full ROS 2 installation, not the course."
    return f"Package '{package}' not found.{did_you_mean(package, sorted({*find_packages(), *sources_near([])}))}"


def package_folders(package: str) -> list[Path]:
    """The folders that may hold a package's launch files."""
    shared = [lib.parent / "share" / package for lib in _lib_folders()]
    return [*shared, *_package_places(package, list(_folders(())))]

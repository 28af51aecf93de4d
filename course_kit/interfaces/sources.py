"""Where the texts of live interfaces lie: folders laid out package/kind/Name.kind, as in a ROS package's share.

Read at the start of every Python of the environment, so nothing but `os` is imported before a package is sought.
"""

from __future__ import annotations

import os
import sys

TYPE_CHECKING = False  # importing typing would cost more than this module
if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

KINDS = ("msg", "srv", "action")
PATH_VARIABLE = "COURSE_KIT_INTERFACE_PATH"
# What comes with the course cannot be replaced by what somebody defines: exercises are graded with it.
OWN_FOLDER = os.path.join(os.path.dirname(__file__), "data")  # noqa: PTH118, PTH120
_ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))  # noqa: PTH100, PTH120
# Sought by Python itself at every start, before anything of the environment may be imported.
_NEVER_PACKAGES = ("sitecustomize", "usercustomize")


def source_folders() -> Iterator[str]:
    """The folders to search, in this order: the course's, COURSE_KIT_INTERFACE_PATH, the learner's definitions."""
    yield OWN_FOLDER
    yield from (folder for folder in os.environ.get(PATH_VARIABLE, "").split(os.pathsep) if folder)
    saved = saved_folder()
    if saved is not None:
        yield saved


def path_with(*first: str) -> str:
    """COURSE_KIT_INTERFACE_PATH with some folders before those that it names."""
    named = os.environ.get(PATH_VARIABLE, "").split(os.pathsep)
    return os.pathsep.join(dict.fromkeys(folder for folder in (*first, *named) if folder))


def saved_folder() -> str | None:
    """Where definitions are saved for other processes of this checkout, None where nothing can be written."""
    loaded = sys.modules.get("course_kit.environment")
    if not hasattr(loaded, "run_dir") and _course_is_writable():
        return os.path.join(_ROOT, ".course", "interfaces")  # noqa: PTH118
    try:
        from course_kit import environment

        return os.path.join(environment.run_dir(), "interfaces")  # noqa: PTH118
    except (AttributeError, ImportError, OSError):  # the first two: environment is itself being imported
        return None


def _course_is_writable() -> bool:
    """Whether `environment.run_dir()` lies in the course's folder: files there may be another user's."""
    if not os.path.isdir(os.path.join(_ROOT, "notebooks")):  # noqa: PTH112, PTH118
        return False
    made = os.path.join(_ROOT, ".course")  # noqa: PTH118
    return os.access(made if os.path.isdir(made) else _ROOT, os.W_OK | os.X_OK, effective_ids=True)  # noqa: PTH112


def has_package(package: str) -> bool:
    """Whether some folder has interfaces of the package. Costs a few microseconds."""
    if package in _NEVER_PACKAGES or package.startswith("_") or not package.islower():
        return False
    return any(has_kind(package, kind, folder) for folder in source_folders() for kind in KINDS)


def has_kind(package: str, kind: str, folder: str | None = None) -> bool:
    """Whether a package has messages, services or actions, in one folder or in any."""
    return any(os.path.isdir(os.path.join(each, package, kind)) for each in ([folder] if folder else source_folders()))  # noqa: PTH112, PTH118


def find_text(package: str, kind: str, name: str) -> str | None:
    """The text of an interface, None if no folder has it."""
    return first_text(source_folders(), package, kind, f"{name}.{kind}")


def first_text(places: Iterable[str], *parts: str) -> str | None:
    """What a file holds in the first of some folders that has it, None if none has."""
    for place in places:
        path = os.path.join(place, *parts)  # noqa: PTH118
        try:
            with open(path, encoding="utf-8") as file:  # noqa: PTH123
                return file.read()
        except UnicodeDecodeError as error:
            raise _not_utf8(path, error) from None
        except OSError:
            continue
    return None


def _not_utf8(path: str, error: UnicodeDecodeError) -> Exception:
    from course_kit.interfaces.errors import InterfaceDefinitionError

    before = error.object[: error.start]
    line = error.object.splitlines()[before.count(b"\n")].decode(errors="replace")
    package, kind, file = path.split(os.sep)[-3:]  # noqa: PTH206
    expected = f"Expected UTF-8, and byte 0x{error.object[error.start]:02x} is none: save {path} with this encoding."
    name = f"{package}/{kind}/{file.rpartition('.')[0]}"
    return InterfaceDefinitionError(name, before.count(b"\n") + 1, line, expected)


def live_names(package: str, kind: str) -> set[str]:
    """The names of a package's live interfaces of one kind."""
    found: set[str] = set()
    for folder in source_folders():
        found.update(_stems(os.path.join(folder, package, kind), f".{kind}"))  # noqa: PTH118
    return found


def live_packages() -> set[str]:
    """The packages any folder has."""
    found: set[str] = set()
    for folder in source_folders():
        found.update(package for package in _list(folder) if has_package(package))
    return found


def _stems(folder: str, ending: str) -> Iterator[str]:
    return (file[: -len(ending)] for file in _list(folder) if file.endswith(ending) and not file.startswith("."))


def _list(folder: str) -> list[str]:
    try:
        return os.listdir(folder)  # noqa: PTH208
    except OSError:
        return []

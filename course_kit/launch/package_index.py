"""Where packages lie, for `get_package_share_directory`: ROS's own index, and packages whose source lies nearby.

`ament_index_python` looks below AMENT_PREFIX_PATH. A package that has not been built is not there, so a folder is made
that looks as if it were installed, with links into its source.
"""

from __future__ import annotations

import ast
import hashlib
import os
import re
import sys
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.launch.errors import LaunchError
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

VARIABLE = "AMENT_PREFIX_PATH"
PACKAGE_PATH = "COURSE_KIT_PACKAGE_PATH"
_INDEX = Path("share", "ament_index", "resource_index", "packages")
_IN_SRC = 5  # levels: src/examples/rclpy/topics/minimal_publisher, of a repository that has been cloned there
_MOST_FOLDERS = 3000  # looked into; what lies in a workspace's `src` are packages, and few folders above them
_NO_SOURCES = ("build", "install", "log", "node_modules", "site-packages")
_LARGEST = 1 << 20  # bytes of a setup.py that are read
_POINT = re.compile(r"\s*(?P<name>[\w.-]+)\s*=\s*(?P<module>[\w.]+)\s*:\s*(?P<function>[\w.]+)\s*")
_NAME = re.compile(r"<name>\s*([A-Za-z0-9][\w-]*)\s*</name>")


def make_known(near: Iterable[Path]) -> None:
    """Have this process, and those it starts, find the packages there are."""
    sources = sources_near(near)
    searched = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    searched += [str(folder.resolve()) for folder in sources.values() if is_one(folder)]
    os.environ["PYTHONPATH"] = os.pathsep.join(dict.fromkeys(filter(None, searched)))
    known = [folder for folder in os.environ.get(VARIABLE, "").split(os.pathsep) if folder]
    if sys.prefix not in known:
        known.append(sys.prefix)
    made = _make_linked_packages(sources)
    if made is not None and str(made) not in known:
        known.insert(0, str(made))
    os.environ[VARIABLE] = os.pathsep.join(known)


def prefix_of(package: str) -> str:
    """The folder that a package is installed in."""
    places = [Path(folder) for folder in os.environ.get(VARIABLE, sys.prefix).split(os.pathsep) if folder]
    for folder in places:
        if (folder / _INDEX / package).is_file():
            return str(folder)
    known = {entry.name for folder in places if (folder / _INDEX).is_dir() for entry in (folder / _INDEX).iterdir()}
    raise LaunchError(f"Package '{package}' not found.{did_you_mean(package, sorted(known))}")


def sources_near(near: Iterable[Path]) -> dict[str, Path]:
    """The packages whose source lies in the workspace around folders, and in the current folder's: names to folders."""
    found: dict[str, Path] = {}
    for root, levels in _roots(near):
        for description in _descriptions(root, levels):
            found.setdefault(_name_in(description), description.parent)
    return found


def _descriptions(root: Path, levels: int) -> Iterator[Path]:
    """The package.xml of each package, the upper ones first; as for colcon, no package lies within another one."""
    folders = [root]
    for _ in range(levels):
        below: list[Path] = []
        for folder in folders[:_MOST_FOLDERS]:
            with suppress(OSError):  # one that may not be read, or has just gone
                if (folder / "package.xml").is_file():
                    yield folder / "package.xml"
                elif not (folder / "COLCON_IGNORE").exists():
                    with os.scandir(folder) as entries:
                        named = (entry for entry in entries if entry.name[0] != "." and entry.name not in _NO_SOURCES)
                        below += sorted(Path(entry) for entry in named if entry.is_dir())
        folders = below


def _roots(near: Iterable[Path]) -> Iterator[tuple[Path, int]]:
    """Folders to look into, each with how many levels deep."""
    here = Path.cwd()
    for folder in (*near, here):
        own = next((place for place in (folder, *folder.parents) if (place / "package.xml").is_file()), None)
        if own is None:
            continue
        yield own, 1
        source = next((place for place in own.parents if place.name == "src"), None)
        yield (own.parent, 3) if source is None else (source, _IN_SRC)
    yield here, 2
    yield here / "src", _IN_SRC
    for named in os.environ.get(PACKAGE_PATH, "").split(os.pathsep):
        if named:
            yield Path(named), 3


def _name_in(description: Path) -> str:
    """The name that a package.xml gives, else its folder's."""
    with suppress(OSError):
        match = _NAME.search(description.read_text(encoding="utf-8", errors="replace"))
        if match is not None:
            return match[1]
    return description.parent.name


def _make_linked_packages(packages: dict[str, Path]) -> Path | None:
    """A folder in which packages look installed; None without any, or where none can be made."""
    if not packages:
        return None
    whose = "\n".join(f"{name}\t{folder.resolve()}" for name, folder in sorted(packages.items()))
    made = environment.run_dir() / "packages" / hashlib.sha256(whose.encode()).hexdigest()[:16]
    try:
        (made / _INDEX).mkdir(parents=True, exist_ok=True)
        for name, folder in packages.items():
            _link(folder.resolve(), made / "share" / name, PurePosixPath("share", name))
            (made / _INDEX / name).touch()
    except OSError:
        return None
    return made


def _link(source: Path, share: Path, target: PurePosixPath) -> None:
    """Fill a share folder with what lies in a package's source, and with what its setup.py puts there."""
    share.mkdir(exist_ok=True)
    pairs = [(entry, share / entry.name) for entry in source.iterdir()]
    for where, file in installed_files(source):
        if where.is_relative_to(target) and not (share / where.relative_to(target)).is_symlink():
            pairs.append((file, share / where.relative_to(target) / file.name))
    for entry, link in pairs:
        if link.parent.is_symlink():  # a folder of the source, where everything is already
            continue
        link.parent.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):  # made by an earlier launch, or at the same time by another one
            link.symlink_to(entry)


def is_one(folder: Path) -> bool:
    """Whether a folder holds the source of a Python package, as `ros2 pkg create` makes it."""
    return (folder / "setup.py").is_file()


def read_programs(folder: Path) -> dict[str, tuple[str, str]]:
    """Module and function of each program that a package's setup.py names; none of what cannot be read."""
    reader = SetupReader(folder)
    return {
        match["name"]: (match["module"], match["function"])
        for node in reader.nodes
        if isinstance(node, ast.Dict)
        for key, scripts in zip(node.keys, node.values, strict=True)
        if isinstance(key, ast.Constant) and key.value == "console_scripts"
        for script in ast.walk(reader.names.get(scripts.id, scripts) if isinstance(scripts, ast.Name) else scripts)
        if (match := _POINT.fullmatch(str(reader.value(script))))
    }


def installed_files(folder: Path) -> Iterator[tuple[PurePosixPath, Path]]:
    """The files that are installed: where to, such as share/my_robot/launch, and where they lie."""
    reader = SetupReader(folder)
    for node in reader.nodes:
        if isinstance(node, ast.Tuple) and len(node.elts) == len(("where to", "files")):
            target, files = (reader.value(part) for part in node.elts)
            if isinstance(target, str) and target.startswith("share/") and isinstance(files, list):
                yield from ((PurePosixPath(target), folder / name) for name in files if (folder / name).is_file())


class SetupReader:
    """A setup.py, read and never run; of an expression that it does not know the value is None."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        try:
            with (folder / "setup.py").open("rb") as file:
                tree = ast.parse(file.read(_LARGEST))
        except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
            tree = ast.Module(body=[], type_ignores=[])
        self.nodes = list(ast.walk(tree))
        self.names = {
            target.id: node.value
            for node in tree.body
            if isinstance(node, ast.Assign)
            for target in node.targets
            if isinstance(target, ast.Name)
        }

    def value(self, node: ast.AST) -> str | list[str] | None:
        if isinstance(node, ast.Constant):
            return node.value if isinstance(node.value, str) else None
        if isinstance(node, ast.Name) and isinstance(self.names.get(node.id), ast.Constant):
            return self.value(self.names[node.id])
        if isinstance(node, ast.List):
            return [text for text in map(self.value, node.elts) if isinstance(text, str)]
        if isinstance(node, ast.JoinedStr):
            return self._join([part.value if isinstance(part, ast.FormattedValue) else part for part in node.values])
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            left, right = self.value(node.left), self.value(node.right)
            return left + right if type(left) is type(right) is not type(None) else None  # type: ignore[operator]
        return self._evaluate_call(node) if isinstance(node, ast.Call) else None

    def _join(self, parts: list[ast.expr], between: str = "") -> str | None:
        texts = [text for text in map(self.value, parts) if isinstance(text, str)]
        return between.join(texts) if len(texts) == len(parts) else None

    def _evaluate_call(self, call: ast.Call) -> str | list[str] | None:
        name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
        if name == "join":
            return self._join(call.args, "/")
        pattern = self.value(call.args[0]) if name == "glob" and call.args else None
        if not isinstance(pattern, str) or Path(pattern).is_absolute():
            return None
        try:
            return sorted(str(path.relative_to(self._folder)) for path in self._folder.glob(pattern))
        except (ValueError, OSError):  # no pattern at all
            return None

"""Python packages of ROS 2 as they lie in a workspace's `src`, before colcon has built them: read, never run."""

from __future__ import annotations

import ast
import configparser
import re
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_LARGEST = 1 << 20  # bytes of a file that is read
_SCRIPTS = "console_scripts"
_POINT = re.compile(r"\s*(?P<name>[\w.-]+)\s*=\s*(?P<module>[\w.]+)\s*:\s*(?P<function>[\w.]+)\s*")


def is_one(folder: Path) -> bool:
    """Whether a folder holds the source of a Python package, as `ros2 pkg create` makes it."""
    return (folder / "setup.py").is_file() or (folder / "setup.cfg").is_file()


def programs(folder: Path) -> dict[str, tuple[str, str]]:
    """Module and function of each program that a package's setup.py or setup.cfg names; none of what is not literal."""
    found: dict[str, tuple[str, str]] = {}
    for line in (*_of_setup_cfg(folder / "setup.cfg"), *_of_setup_py(folder / "setup.py")):
        if match := _POINT.fullmatch(line):
            found[match["name"]] = match["module"], match["function"]
    return found


def _text_of(path: Path) -> str:
    try:
        with path.open("rb") as file:
            return file.read(_LARGEST).decode("utf-8", errors="replace")
    except OSError:
        return ""


def _of_setup_py(path: Path) -> Iterator[str]:
    """The texts in the list `console_scripts` of what is given to `setup` as `entry_points`."""
    try:
        tree = ast.parse(_text_of(path))
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return
    named = {
        target.id: node.value
        for node in tree.body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    reader = SetupReader(path.parent, tree)
    for call in ast.walk(tree):
        if isinstance(call, ast.Call):
            for keyword in call.keywords:
                if keyword.arg == "entry_points":
                    yield from _scripts_in(_resolved(keyword.value, named), named, reader)


def _scripts_in(points: ast.expr, named: dict[str, ast.expr], reader: SetupReader) -> Iterator[str]:
    if not isinstance(points, ast.Dict):
        return
    for key, value in zip(points.keys, points.values, strict=True):
        scripts = _resolved(value, named)
        if isinstance(key, ast.Constant) and key.value == _SCRIPTS and isinstance(scripts, (ast.List, ast.Tuple)):
            for one in scripts.elts:
                if isinstance(text := reader.value(one), str):  # often made of `package_name +`
                    yield text


def _resolved(value: ast.expr, named: dict[str, ast.expr]) -> ast.expr:
    return named.get(value.id, value) if isinstance(value, ast.Name) else value


def _of_setup_cfg(path: Path) -> Iterator[str]:
    parser = configparser.ConfigParser(interpolation=None, strict=False)
    try:
        parser.read_string(_text_of(path))
    except configparser.Error:
        return
    yield from parser.get("options.entry_points", _SCRIPTS, fallback="").splitlines()


def installed(folder: Path) -> Iterator[tuple[PurePosixPath, Path]]:
    """The files that are installed: where to, such as share/my_robot/launch, and where they lie."""
    try:
        with (folder / "setup.py").open("rb") as file:
            tree = ast.parse(file.read(_LARGEST))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return
    reader = SetupReader(folder, tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.Tuple) and len(node.elts) == len(("where to", "files")):
            target, files = (reader.value(part) for part in node.elts)
            if isinstance(target, str) and target.startswith("share/") and isinstance(files, list):
                yield from ((PurePosixPath(target), folder / name) for name in files if (folder / name).is_file())


class SetupReader:
    """Finds what expressions of a setup.py mean; None for what it does not know."""

    def __init__(self, folder: Path, tree: ast.Module) -> None:
        self._folder = folder
        self._named = {
            target.id: node.value
            for node in tree.body
            if isinstance(node, ast.Assign)
            for target in node.targets
            if isinstance(target, ast.Name) and isinstance(node.value, ast.Constant)
        }

    def value(self, node: ast.expr) -> str | list[str] | None:
        """A text, or a list of paths."""
        if isinstance(node, ast.Constant):
            return node.value if isinstance(node.value, str) else None
        if isinstance(node, ast.Name):
            return self.value(self._named[node.id]) if node.id in self._named else None
        if isinstance(node, ast.List):
            return [text for text in map(self.value, node.elts) if isinstance(text, str)]
        return self._computed(node)

    def _computed(self, node: ast.expr) -> str | list[str] | None:
        if isinstance(node, ast.JoinedStr):
            return self._joined([part.value if isinstance(part, ast.FormattedValue) else part for part in node.values])
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            return self._sum(self.value(node.left), self.value(node.right))
        return self._called(node) if isinstance(node, ast.Call) else None

    @staticmethod
    def _sum(left: str | list[str] | None, right: str | list[str] | None) -> str | list[str] | None:
        if isinstance(left, str) and isinstance(right, str):
            return left + right
        return left + right if isinstance(left, list) and isinstance(right, list) else None

    def _joined(self, parts: list[ast.expr], between: str = "") -> str | None:
        texts = [self.value(part) for part in parts]
        known = [text for text in texts if isinstance(text, str)]
        return between.join(known) if len(known) == len(texts) else None

    def _called(self, call: ast.Call) -> str | list[str] | None:
        name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
        if name == "join":
            return self._joined(call.args, "/")
        pattern = self.value(call.args[0]) if name == "glob" and call.args else None
        if not isinstance(pattern, str) or Path(pattern).is_absolute():
            return None
        try:
            return sorted(str(path.relative_to(self._folder)) for path in self._folder.glob(pattern))
        except (ValueError, OSError):  # no pattern at all
            return None

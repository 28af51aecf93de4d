"""Python packages of ROS 2 as they lie in a workspace's `src`, before colcon has built them: read, never run."""

from __future__ import annotations

import ast
import configparser
import re
from typing import TYPE_CHECKING

from course_kit.launch.data_files import SetupReader

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

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

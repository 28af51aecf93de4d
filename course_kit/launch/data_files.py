"""What a package's setup.py installs into its share folder, read from the text: it is never run.

Most packages of ROS 2 write `(os.path.join('share', package_name, 'launch'), glob('launch/*.launch.py'))`, with names,
`+`, f-strings, `os.path.join` and `glob`. What is written in another way is not seen.
"""

from __future__ import annotations

import ast
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_LARGEST = 1 << 20  # bytes of a setup.py


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

"""Makes `launch`, `launch_ros` and what belongs to them importable; last on `sys.meta_path`, so that the real ones win.

Put in place at the start of every interpreter, so everything else is left to the moment a launch file is read.
"""

from __future__ import annotations

import sys
from importlib.machinery import ModuleSpec

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType

_ROOTS = ("launch", "launch_ros")


class LaunchFinder:
    """A meta path finder and loader (see "The import system" in Python's reference)."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        del path, target
        root = fullname.partition(".")[0]
        if root not in _ROOTS:
            return None
        from course_kit.launch import modules

        if modules.contents_of(fullname) is not None:
            return ModuleSpec(fullname, self, origin="course kit", is_package=True)  # type: ignore[arg-type]
        if fullname != root and is_ours(sys.modules.get(root)):
            raise ModuleNotFoundError(modules.explain_absence(fullname), name=fullname)
        return None

    def create_module(self, spec: ModuleSpec) -> None:
        """Leave the making of the module to the import system."""

    def exec_module(self, module: ModuleType) -> None:
        from course_kit.launch import modules

        modules.fill_module(module)


def is_ours(module: ModuleType | None) -> bool:
    """Whether a module is the course kit's and not the real one."""
    return module is not None and isinstance(getattr(module.__spec__, "loader", None), LaunchFinder)


def install_finder() -> None:
    """Put the finder in place, once."""
    if not any(isinstance(finder, LaunchFinder) for finder in sys.meta_path):
        sys.meta_path.append(LaunchFinder())


def come_before_folders() -> None:
    """Have the finder asked first, unless a real package is there."""
    from importlib.machinery import PathFinder

    install_finder()
    for root in _ROOTS:
        spec = PathFinder.find_spec(root)
        if spec is not None and spec.origin is not None:  # a namespace package has no origin
            return
    sys.meta_path.sort(key=lambda finder: not isinstance(finder, LaunchFinder))

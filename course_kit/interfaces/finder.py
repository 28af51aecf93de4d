"""Makes live interfaces importable: `from my_interfaces.srv import PersonInfo`, in any Python of the environment.

The finder stands last on `sys.meta_path`, so a package that is really installed wins. It is put there at the start of
every interpreter and must cost next to nothing: even `typing` and `importlib.abc` are left to those who need them.
"""

from __future__ import annotations

import sys
from _thread import allocate_lock, get_ident
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType

from course_kit.interfaces import sources

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from course_kit.interfaces.definition import TypeName
    from course_kit.interfaces.library import BuiltDefinition, Library

_PACKAGE, _KIND, _MODULE = 1, 2, 3  # parts of the name: my_interfaces . srv . _person_info


class LiveFinder:
    """Finds the packages of live interfaces; a meta path finder and loader (see "The import system")."""

    def __init__(self) -> None:
        self._library: Library | None = None
        self._lock = allocate_lock()
        self._searching: set[int] = set()  # threads in find_spec

    @property
    def library(self) -> Library:
        """The live types of this process."""
        with self._lock:
            if self._library is None:
                self._library = _new_library()
            return self._library

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find a package of live interfaces, its msg, srv or action, or the module of one of them."""
        del path, target
        thread = get_ident()
        if thread in self._searching:  # looking for folders imports modules; those that do not exist come by here
            return None
        self._searching.add(thread)
        try:
            depth = fullname.count(".") + 1
            if depth > _MODULE or not self._has(fullname.split("."), depth):
                return None
        finally:
            self._searching.discard(thread)
        return ModuleSpec(fullname, self, origin="live interfaces", is_package=depth < _MODULE)  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """Make the module object; those with types in them look a type up when it is asked for."""
        depth = spec.name.count(".") + 1
        return None if depth == _PACKAGE else _TypesModule(spec.name, self)

    def exec_module(self, module: ModuleType) -> None:
        """Nothing to run: types are made when they are asked for."""

    def find(self, module: str, name: str) -> type | None:
        """The class `name` of a module such as "my_interfaces.srv" or "my_interfaces.srv._person_info"."""
        package, kind, *_ = module.split(".")
        built = self._build_definition(package, kind, name)
        return None if built is None else built.find(name)

    def names(self, module: str) -> set[str]:
        """The interfaces a module such as "my_interfaces.srv" offers."""
        package, kind, *rest = module.split(".")
        return set() if rest else self._names(package, kind)

    def _build_definition(self, package: str, kind: str, name: str) -> BuiltDefinition | None:
        library = self.library  # first: it explains what is missing without ROS 2
        from course_kit.interfaces.definition import TypeName

        interface = name.removeprefix("Metaclass_").partition("_")[0]
        return library.get(TypeName(package, kind, interface))

    def _has(self, parts: list[str], depth: int) -> bool:
        package = parts[0]
        if depth == _PACKAGE:
            return sources.has_package(package) or any(name.package == package for name in self._types())
        kind = parts[1]
        if kind not in sources.KINDS:
            return False
        if depth == _KIND:
            return sources.has_kind(package, kind) or bool(self._names(package, kind))
        from course_kit.interfaces.definition import module_name

        return parts[2] in {module_name(name) for name in self._names(package, kind)}

    def _names(self, package: str, kind: str) -> set[str]:
        """On disk or, where that could not be written, in this process only."""
        return sources.live_names(package, kind) | {made.name for made in self._types() if made[:2] == (package, kind)}

    def _types(self) -> list[TypeName]:
        return [] if self._library is None else self._library.names()


class _TypesModule(ModuleType):
    """A module whose types are made when first asked for, and anew once they are defined anew."""

    def __init__(self, name: str, finder: LiveFinder) -> None:
        super().__init__(name)
        self.__dict__["_finder"] = finder

    def __getattr__(self, name: str) -> Any:
        finder: LiveFinder = self.__dict__["_finder"]
        if name == "__all__":
            return sorted(finder.names(self.__name__))
        found = None if name.startswith("__") or not name[:1].isupper() else finder.find(self.__name__, name)
        if found is None and not name.startswith("__") and name in finder.names(self.__name__):
            from course_kit.interfaces.parser import parse_type_name

            parse_type_name(f"{self.__name__.replace('.', '/')}/{name}")  # there is a file, and its name is no type's
        if found is None:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}", name=name, obj=self)
        return found

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *self.__dict__["_finder"].names(self.__name__)})


def _new_library() -> Library:
    try:
        from course_kit.interfaces.library import Library
    except ModuleNotFoundError as error:
        if error.name != "rosidl_parser":
            raise
        raise ImportError(
            "The course's interfaces need ROS 2 Jazzy, which this Python does not have. Use the Python of the course "
            "(.venv/bin/python, made by ./course), or source your ROS 2 Jazzy first."
        ) from error
    return Library(lambda name: sources.find_text(*name))


class PackagesFirst(PathFinder):
    """Python's own finder, for which a folder without an `__init__.py` hides no package of the kit (PEP 420)."""

    @classmethod
    def find_spec(
        cls, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find a module; a namespace package only where no finder behind this one has a package of that name."""
        spec = super().find_spec(fullname, path, target)
        if spec is None or spec.loader is not None or path is not None:
            return spec
        behind = sys.meta_path[sys.meta_path.index(cls) + 1 :] if cls in sys.meta_path else []
        return next((found for finder in behind if (found := finder.find_spec(fullname, None)) is not None), spec)


def install() -> None:
    """Put the finder last on `sys.meta_path`; calling it again changes nothing."""
    if not any(isinstance(finder, LiveFinder) for finder in sys.meta_path):
        sys.meta_path[:] = [PackagesFirst if finder is PathFinder else finder for finder in sys.meta_path]
        sys.meta_path.append(LiveFinder())


def get_finder() -> LiveFinder:
    """The finder of this process, put in place if it is not."""
    install()
    return next(finder for finder in sys.meta_path if isinstance(finder, LiveFinder))


def is_live(module: ModuleType) -> bool:
    """Whether a module is one of live interfaces."""
    return isinstance(getattr(module.__spec__, "loader", None), LiveFinder)

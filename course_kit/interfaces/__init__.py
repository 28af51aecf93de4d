"""Live interfaces: .msg, .srv and .action text becomes a type at once, on the wire the same as a compiled one.

No compiler and no build: see `define`. Types that come with the course, and those a learner has defined, can be
imported like any other in every Python of the environment. Nothing here is loaded before it is used.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from course_kit.interfaces.defining import define
    from course_kit.interfaces.errors import InterfaceDefinitionError, InterfaceNotFoundError, NativeHelperError
    from course_kit.interfaces.finder import install
    from course_kit.interfaces.known_types import get_type, packages, text_of, types

__all__ = [
    "InterfaceDefinitionError",
    "InterfaceNotFoundError",
    "NativeHelperError",
    "define",
    "get_type",
    "install",
    "packages",
    "text_of",
    "types",
]

_HOMES = {
    "define": "defining",
    "install": "finder",
    **dict.fromkeys(("InterfaceDefinitionError", "InterfaceNotFoundError", "NativeHelperError"), "errors"),
    **dict.fromkeys(("get_type", "packages", "text_of", "types"), "known_types"),
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)

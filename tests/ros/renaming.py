"""Renames a private name all over rclpy, as a later version might: rclpy works on, and the old name is gone."""

from __future__ import annotations

import importlib
import sys
from contextlib import suppress
from types import CodeType, FunctionType
from typing import Any

_LATER = "_of_a_later_version"


def rename(path: str) -> None:
    """Give a name of the table, `module:attribute.attribute`, another name.

    What is no attribute of rclpy's, and what a C library looks for under its name, is only taken away.
    """
    module_name, _, attributes = path.partition(":")
    old = attributes.rpartition(".")[2]
    owner: Any = importlib.import_module(module_name)
    for step in attributes.split(".")[:-1]:
        owner = getattr(owner, step)
    for module in _modules(module_name, owner):
        _rename_in(module, old)
    for place in [owner, *getattr(owner, "__mro__", ())]:
        if old in vars(place):
            _move(place, old)


def _modules(name: str, owner: Any) -> list[Any]:
    """The modules whose code may use the name: all of rclpy, of other packages the one that owns it."""
    if name.partition(".")[0] == "rclpy":
        return [module for other, module in list(sys.modules.items()) if other.partition(".")[0] == "rclpy"]
    return [sys.modules[getattr(owner, "__module__", name)]]


def _rename_in(module: Any, old: str) -> None:
    """Have all code of a module use the new name, and its classes offer it."""
    for value in list(vars(module).values()):
        if isinstance(value, FunctionType) and value.__module__ == module.__name__:
            _rename_in_function(value, old)
        elif isinstance(value, type) and value.__module__ == module.__name__:
            for part in list(vars(value).values()):
                for function in _functions_of(part):
                    _rename_in_function(function, old)
            if old in vars(value):
                _move(value, old)


def _functions_of(part: Any) -> list[FunctionType]:
    found = (part.fget, part.fset) if isinstance(part, property) else (getattr(part, "__func__", part),)
    return [one for one in found if isinstance(one, FunctionType)]


def _rename_in_function(function: FunctionType, old: str) -> None:
    function.__code__ = _renamed(function.__code__, old)


def _renamed(code: CodeType, old: str) -> CodeType:
    def names(given: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(name + _LATER if name == old else name for name in given)

    constants = tuple(_renamed(one, old) if isinstance(one, CodeType) else one for one in code.co_consts)
    arguments = code.co_argcount + code.co_kwonlyargcount  # may be passed by keyword
    variables = code.co_varnames[:arguments] + names(code.co_varnames[arguments:])
    return code.replace(co_names=names(code.co_names), co_varnames=variables, co_consts=constants)


def _move(owner: Any, old: str) -> None:
    with suppress(TypeError, AttributeError):
        setattr(owner, old + _LATER, vars(owner)[old])
    delattr(owner, old)

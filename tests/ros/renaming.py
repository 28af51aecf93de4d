"""Takes a private name out of rclpy as a later version might: rclpy itself works on, and the name is gone.

An attribute of a class gets another name there and in the code that uses it. A name of a module is hidden from whoever
imports it from now on; the module's own functions still have it.
"""

from __future__ import annotations

import importlib
import sys
from types import CodeType, FunctionType, ModuleType
from typing import Any

_LATER = "_of_a_later_version"
_USERS = "rclpy.executors"  # uses private attributes of classes of other modules


def take_away(path: str) -> None:
    """Take away a name of the table, `module:attribute.attribute`."""
    module_name, _, attributes = path.partition(":")
    *steps, old = attributes.split(".")
    owner: Any = importlib.import_module(module_name)
    holder: Any = None
    for step in steps:
        holder, owner = owner, getattr(owner, step)
    if isinstance(owner, FunctionType):
        owner.__code__ = owner.__code__.replace(co_varnames=_renamed(owner.__code__.co_varnames, old))
    elif not isinstance(owner, ModuleType):
        _rename(owner, old)
    elif holder is not None:
        setattr(holder, steps[-1], _without(owner, old))
    else:
        sys.modules[module_name] = hidden = _without(owner, old)
        package, _, name = module_name.rpartition(".")
        setattr(sys.modules[package], name, hidden)


def _without(module: ModuleType, old: str) -> ModuleType:
    copy = ModuleType(module.__name__)
    vars(copy).update({name: value for name, value in vars(module).items() if name != old})
    return copy


def _rename(owner: type, old: str) -> None:
    names = {owner.__module__} | ({_USERS} if owner.__module__.startswith("rclpy.") else set())
    for module in (sys.modules[name] for name in names):
        for value in list(vars(module).values()):
            if getattr(value, "__module__", None) == module.__name__:
                _rename_in(value, old)
    for place in owner.__mro__:
        if old in vars(place):
            setattr(place, old + _LATER, vars(place)[old])
            delattr(place, old)


def _rename_in(value: Any, old: str) -> None:
    """Have a function or the methods of a class use the new name; and the methods of its metaclass."""
    parts = [value]
    if isinstance(value, type):
        parts = [*vars(value).values(), *vars(type(value)).values()]
    for part in parts:
        functions = (part.fget, part.fset) if isinstance(part, property) else (getattr(part, "__func__", part),)
        for function in functions:
            if isinstance(function, FunctionType):
                function.__code__ = _code(function.__code__, old)


def _code(code: CodeType, old: str) -> CodeType:
    constants = tuple(_code(one, old) if isinstance(one, CodeType) else one for one in code.co_consts)
    return code.replace(co_names=_renamed(code.co_names, old), co_consts=constants)


def _renamed(names: tuple[str, ...], old: str) -> tuple[str, ...]:
    return tuple(name + _LATER if name == old else name for name in names)

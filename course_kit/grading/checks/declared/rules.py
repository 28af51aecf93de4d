"""What the values of a declared check have to keep to beside their forms and fields."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.declared import inputs
from course_kit.grading.checks.declared.values import as_list
from course_kit.ros.messages import with_article
from course_kit.ros.names import did_you_mean
from course_kit.ros.parameters import NOT_SET, TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from course_kit.grading.plain_data import Record

_DECLARED = "parameter_declared"
_OF_PYTHON = {bool: "bool", int: "integer", float: "double", str: "string"}
_KNOWN = tuple(name for name in TYPES if name != NOT_SET)


def types_of(checks: Sequence[Record]) -> dict[str, str]:
    """The parameters that an exercise's checks declare, each with its type; that is empty where none is told."""
    found: dict[str, str] = {}
    for one in checks:
        if one.get("kind") == _DECLARED:
            for name, (kind, _) in wanted_of(one).items():
                found[name] = kind or found.get(name, "")
    return found


def wanted_of(table: Mapping[str, Any]) -> dict[str, tuple[str, Any]]:
    """The parameters that a check wants declared, each with its type, empty for any, and its default, None for any."""
    found: dict[str, tuple[str, Any]] = {}
    if isinstance(table.get("parameter"), str):
        found[table["parameter"]] = (str(table.get("type") or type_of(table.get("default"))), table.get("default"))
    types, defaults = (one if isinstance(one := table.get(key), dict) else {} for key in ("types", "defaults"))
    names = table.get("parameters")
    for name in map(str, [*(names if isinstance(names, (list, tuple)) else ()), *types, *defaults]):
        found[name] = (str(types.get(name) or type_of(defaults.get(name))), defaults.get(name))
    return found


def type_of(value: Any) -> str:
    """The type of the parameter that holds such a value, `double`; empty for what no parameter holds."""
    if isinstance(value, list) and value:
        element = _OF_PYTHON.get(type(value[0]), "")
        return f"{element}_array" if element else ""
    return _OF_PYTHON.get(type(value), "")


def problems(table: Record, types: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """What is wrong with a check, and the key that it is about.

    Args:
        table: the check.
        types: of the parameters that the exercise's checks declare.
    """
    if table["kind"] == _DECLARED:
        yield from _of_declared(table)
    if table["kind"] == "parameter_acts":
        yield from _of_acting(table, types)
    for key in ("messages", "requests", "goals"):
        if key in table and sum(map(inputs.count_of, as_list(table[key]))) > inputs.MOST:
            yield f"'{key}' makes more than {inputs.MOST} of them.", key


def _of_declared(table: Record) -> Iterator[tuple[str, str]]:
    if "parameter" not in table:
        yield from (
            (f"'{key}' is of one 'parameter', which is missing.", key) for key in ("type", "default") if key in table
        )
        if not wanted_of(table):
            yield "'parameter' is missing, or several: 'parameters', 'types' or 'defaults'.", ""
    for name, (wanted, default) in wanted_of(table).items():
        key = "type" if name == table.get("parameter") else "types"
        if wanted and wanted not in _KNOWN:
            yield (
                f"A parameter has no type '{wanted}'.{did_you_mean(wanted, _KNOWN)} There are {', '.join(_KNOWN)}.",
                key,
            )
        elif wanted and default is not None and type_of(default) not in ("", wanted):
            key = "default" if key == "type" else "defaults"
            of = "'type' is" if key == "default" else f"The type of {name} is"
            yield f"{of} {wanted}, but the default {default!r} is {with_article(type_of(default))}.", key


def _of_acting(table: Record, types: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    for name, value in [pair for one in as_list(table["set"]) for pair in one.items()]:
        if types and name not in types:
            yield f"No check of the kind '{_DECLARED}' declares a parameter '{name}'.{did_you_mean(name, types)}", "set"
            continue
        if inputs.is_drawn(value) and (problem := inputs.problem_of(value)):
            yield problem, "set"
            continue
        values = inputs.examples(value) if inputs.is_drawn(value) else [value]
        for one in values:
            if types.get(name) and type_of(one) not in ("", types[name]):
                meant = f": write {float(one)!r}" if types[name] == "double" and isinstance(one, int) else ""
                yield f"The parameter '{name}' is a {types[name]}, and {one!r} a {type_of(one)}{meant}.", "set"
                break

"""Looks over the values of a declared check's keys: fields against their interface, expressions against names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.declared import inputs, kinds
from course_kit.grading.checks.declared.evaluation import ExpressionError
from course_kit.grading.checks.declared.expressions import Expression
from course_kit.ros.names import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from course_kit.grading.checks.declared.definitions import Fields

_FORMS: dict[str, tuple[tuple[type, ...], str]] = {
    kinds.TEXT: ((str,), "a text"),
    kinds.TEXTS: ((list,), "a list of texts"),
    kinds.NUMBER: ((int, float), "a number above 0"),
    kinds.COUNT: ((int,), "a whole number above 0"),
    kinds.TRUTH: ((bool,), "true or false"),
    kinds.INPUTS: ((list, dict), "a list of tables, such as [{x = 1.0}]"),
    kinds.CASES: ((list,), "a list of tables"),
    kinds.FIELDS: ((dict,), "a table of fields, such as {x = 1.0}"),
    kinds.EXPECT: ((dict, str), "a table of fields, or an expression for all of them"),
    kinds.TOLERANCE: (
        (int, float, dict, str),
        'a number, "exact", or {relative = 1e-6, absolute = 1e-9}',
    ),
    kinds.SETTINGS: ((list, dict), "a list of tables, such as [{max_velocity = 0.5}]"),
    kinds.VALUE: ((bool, int, float, str, list), "a value that a parameter can have"),
    kinds.VALUES: ((dict,), "a table of values by the names of parameters, such as {max_velocity = 0.5}"),
    kinds.TYPES: ((dict,), 'a table of types by the names of parameters, such as {max_velocity = "double"}'),
    kinds.WORDS: ((str,), "an expression that gives a text, such as \"'a negative number'\""),
}


def problem_of_form(form: str, value: Any) -> str:  # noqa: PLR0911 - a table of forms
    """What a value has to be instead, or nothing."""
    types, wanted = _FORMS[form]
    if not _is_one_of(value, types):
        return wanted
    if form in (kinds.NUMBER, kinds.COUNT) and not 0 < value < float("inf"):
        return wanted
    if form in (kinds.TEXT, kinds.WORDS) and not value.strip():
        return "a text that is not empty"
    if form == kinds.TEXTS and not all(isinstance(one, str) for one in value):
        return wanted
    if form == kinds.TYPES and not all(isinstance(one, str) for one in value.values()):
        return wanted
    if form in (kinds.INPUTS, kinds.CASES, kinds.SETTINGS) and not _are_tables(value):
        return wanted
    if form == kinds.TOLERANCE and not _is_tolerance(value):
        return wanted
    return ""


def _is_one_of(value: object, types: tuple[type, ...]) -> bool:
    return isinstance(value, types) and (bool in types or not isinstance(value, bool))


def as_list(value: Any) -> list[Any]:
    """The tables of a key that may hold a single one."""
    return value if isinstance(value, list) else [value]


def _are_tables(value: Any) -> bool:
    return all(isinstance(one, dict) for one in as_list(value)) and bool(value)


def _is_tolerance(value: Any) -> bool:
    if isinstance(value, str):
        return value == "exact"
    if isinstance(value, dict):
        numbers = all(
            isinstance(one, (int, float)) and not isinstance(one, bool) and one >= 0 for one in value.values()
        )
        return bool(value) and set(value) <= {"relative", "absolute"} and numbers
    return bool(value >= 0)


def look_over_fields(table: Mapping[str, Any], fields: Fields, tell: Callable[..., None]) -> None:
    """Find what a message cannot be filled with.

    Args:
        table: fields and their values, some of which may be drawn.
        fields: those of the message.
        tell: gets each problem, and words of the text that it is about.
    """
    for name, value in table.items():
        if name not in fields.types:
            tell(fields.problem_of_path((name,)), name)
        elif inputs.is_drawn(value):
            if problem := inputs.problem_of(value):
                tell(problem, name, *value)
                continue
            problems = (fields.problem_of_value(name, one) for one in inputs.examples(value))
            if found := next(filter(None, problems), ""):
                tell(found, name, *value)
        elif isinstance(value, dict) and (inner := fields.inside(name)) is not None:
            look_over_fields(value, inner, tell)
        elif found := fields.problem_of_value(name, value):
            tell(found, name)


def look_over_expected(
    expected: Any, fields: Fields | None, names: Mapping[str, Fields | None], tell: Callable[..., None]
) -> None:
    """Find what cannot be expected of a message.

    Args:
        expected: fields and their values, of which texts are expressions; or one expression.
        fields: those of the message; None where its interface is not known.
        names: the names of expressions, each with its fields; None where these are not known.
        tell: gets each problem, and words of the text that it is about.
    """
    if isinstance(expected, str):
        look_over_expression(expected, names, tell)
        return
    for name, value in expected.items():
        if fields is not None and name not in fields.types:
            tell(fields.problem_of_path((name,)), name)
        elif isinstance(value, str):
            look_over_expression(value, names, tell)
        elif isinstance(value, dict):
            look_over_expected(value, None if fields is None else fields.inside(name), names, tell)
        elif fields is not None and (found := fields.problem_of_value(name, value)):
            tell(found, name)


def look_over_expression(text: str, names: Mapping[str, Fields | None], tell: Callable[..., None]) -> None:
    """Find what is wrong with an expression.

    Args:
        text: as it is written.
        names: those it may use, each with its fields; None where these are not known.
        tell: gets each problem, and words of the text that it is about.
    """
    try:
        expression = Expression.parse(text)
    except ExpressionError as refused:
        tell(f'The expression "{text}" cannot be used: {refused}.{_quoted(text)}', text)
        return
    for name, *path in expression.paths():
        if name not in names:
            problem = f"there is no '{name}' here.{did_you_mean(name, names)} There are {', '.join(names)}"
            tell(f'The expression "{text}" cannot be used: {problem}.{_quoted(text)}', text)
        elif (fields := names[name]) is not None and (found := fields.problem_of_path(tuple(path))):
            tell(f'In the expression "{text}": {found}', text)


def _quoted(text: str) -> str:
    """How to write a text that is to be expected as it is, where this looks like one."""
    return f" To expect this very text, write \"'{text}'\"." if text.replace(" ", "").isalnum() else ""

"""Expressions: what they work out to, and what they refuse."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_kit.grading.checks.declared.evaluation import ExpressionError
from course_kit.grading.checks.declared.expressions import Expression

NAMES = {
    "request": {"a": 3, "b": 4.0, "name": "rover", "values": [1.0, 2.0, 4.0], "point": {"x": 0.5, "y": -2.0}},
    "parameters": {"max.speed": 1.5, "limit": 2.0, "enabled": False},
}


def value(text: str) -> object:
    return Expression.parse(text).value(NAMES)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("request.a + request.b * 2", 11.0),
        ("-request.point.y ** 2", -4.0),
        ("7 // 2 + 7 % 4", 6),
        ("0.0 if abs(request.point.x) < 0.6 else request.point.x", 0.0),
        ("clamp(9.0, -parameters.limit, parameters.limit)", 2.0),
        ("hypot(request.a, request.b)", 5.0),
        ("floor(2.7) + ceil(2.1) + round(2.567, 1) + sqrt(16)", 11.6),
        ("max(request.values) - min(1, 2, 3) + sum(request.values) + len(request.values)", 13.0),
        ("request.values[2] + request.values[-1]", 8.0),
        ('parameters["max.speed"]', 1.5),
        ("not parameters.enabled and 1 < request.a <= 3", True),
        ("request.name + '!' == 'rover!' or false", True),
        ("request.name in ('rover', 'tank')", True),
        ("isfinite(inf) or isnan(nan)", True),
        ("[request.a, 2, 3]", [3, 2, 3]),
        ("request.point", {"x": 0.5, "y": -2.0}),
        ("cos(pi)", -1.0),
    ],
)
def test_an_expression_has_its_value(text: str, wanted: object) -> None:
    found = value(text)
    assert found == (pytest.approx(wanted) if isinstance(wanted, float) else wanted)


def test_what_is_not_needed_is_not_worked_out() -> None:
    assert value("0.0 if request.a == 3 else 1 / 0") == 0.0
    assert value("request.a == 3 or 1 / 0 > 1") is True
    assert value("request.a == 4 and 1 / 0 > 1") is False


numbers = st.one_of(st.integers(-50, 50).map(str), st.floats(-9, 9, allow_nan=False).map(repr), st.just("request.a"))
arithmetic = st.recursive(
    numbers,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*/"), inner).map(lambda parts: f"({' '.join(parts)})"),
        inner.map(lambda one: f"abs({one})"),
        st.tuples(inner, inner, inner).map(lambda parts: f"({parts[0]} if {parts[1]} < 2 else {parts[2]})"),
    ),
    max_leaves=8,
)


@given(arithmetic)
def test_arithmetic_is_pythons(text: str) -> None:
    class Request:
        a = 3

    try:
        wanted = eval(text, {"request": Request, "abs": abs})  # noqa: S307 - what Python says, of harmless texts
    except ZeroDivisionError:
        with pytest.raises(ExpressionError, match="has no value"):
            value(text)
        return
    assert value(text) == wanted or math.isnan(wanted)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("request.", "it is no expression"),
        ("", "it is no expression"),
        ("a = 3", "it is no expression"),
        ("lambda: 3", "not allowed here .Lambda"),
        ("[x for x in request.values]", "not allowed here .ListComp"),
        ("f'{request.a}'", "not allowed here .JoinedStr"),
        ("(x := 3)", "not allowed here .NamedExpr"),
        ("request.values[0:2]", "not allowed here .Slice"),
        ("{1: 2}", "not allowed here .Dict"),
        ("1 << 9", "not allowed here .LShift"),
        ("3j", "3j is no number"),
        ("None", "None is no number"),
        ("b'a'", "is no number"),
        ("abss(request.a)", "no function abss.*Did you mean abs"),
        ("round(1.5, digits=1)", "no arguments by name"),
        ("request.a.bit_length()", "only the functions"),
        ("(lambda: 3)()", "only the functions"),
        ("__import__('os')", "no function __import__"),
        ("request.__class__", "no field '__class__'"),
        ("().__class__.__bases__", "no field"),
        ("request._a", "no field '_a'"),
        ("1 + " * 150 + "1", "longer than 500|too many parts"),
        ("-" * 60 + "1", "too many parts"),
        ("(" * 230 + "1" + ")" * 230, "no expression"),
        ("9" * 480 + "." + "9" * 30, "longer than 500"),
    ],
)
def test_what_is_no_expression_is_refused(text: str, said: str) -> None:
    with pytest.raises(ExpressionError, match=said):
        Expression.parse(text)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("9 ** 9 ** 9", "power"),
        ("10 ** 64", "64 bits"),
        ("9.0 ** 64 ** 1.5", "power"),
        ("(-8) ** 0.5", "no real number"),
        ("1 / (request.a - 3)", "division by zero"),
        ("sqrt(-1)", "has no value"),
        ("floor(inf)", "has no value"),
        ("round(1.5, 99)", "digits"),
        ("request.name * 9", "a number is needed"),
        ("request.name + 1", "a number is needed"),
        ("request.name < 1", "a number is needed"),
        ("request.c", "no field 'c'"),
        ("request.a.b", "no field 'b'"),
        ("request.values[9]", "has no value"),
        ("request.values['a']", "only a list"),
        ("requests.a", "no 'requests' here.*Did you mean request"),
        ("request.a if request.a else 1", "neither true nor false"),
        ("min()", "has no value"),
        ("clamp(1)", "has no value"),
        ("abs(request.name)", "a number is needed"),
    ],
)
def test_what_has_no_value_says_why(text: str, said: str) -> None:
    with pytest.raises(ExpressionError, match=said):
        value(text)


@pytest.mark.attack("an expression in an exercise.toml that would take for ever, or all memory")
@pytest.mark.parametrize(
    "text",
    [
        "9 ** 9 ** 9 ** 9",
        "((9 ** 19) ** 19) ** 19",
        "(request.name + request.name)" + " + request.name" * 20,
        "9 ** 64 * 9 ** 64 * 9 ** 64",
        "[[[[1] + [1]] + [1]] + [1]] + [1]",
        "+".join(["(1)"] * 99),
    ],
)
def test_nothing_grows_without_bound(text: str) -> None:
    try:
        found = value(text)
    except ExpressionError:
        found = 0
    assert len(repr(found)) < 10_000


def test_paths_are_what_is_looked_up() -> None:
    paths = Expression.parse(
        "hypot(request.point.x, request.a) + parameters['max.speed'] + pi + request.values[0]"
    ).paths()
    assert sorted(paths) == [
        ("parameters", "max.speed"),
        ("request", "a"),
        ("request", "point", "x"),
        ("request", "values"),
    ]

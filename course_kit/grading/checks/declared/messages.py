"""Messages as plain data, and the two compared and shown."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.declared.expressions import Expression
from course_kit.grading.checks.declared.kinds import ORACLE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from course_kit.grading.checks.declared.declaration import Declaration
    from course_kit.ros.messages import Message

_RELATIVE, _ABSOLUTE = 1e-6, 1e-9  # the right formula, whatever has become of the last digits
_DIGITS = 10  # of a number that is shown
_LONGEST = 60  # characters of a text that is shown, and elements of a list
_MOST = 12  # fields of a part that is shown
_FEW = 4  # fields; of larger messages only those are shown that are not zero
MISSING = object()
PARAMETERS = "parameters"  # their name in expressions


@dataclass(frozen=True)
class Tolerance:
    """How far a float may be off, relative or absolute, whichever allows more."""

    relative: float = _RELATIVE
    absolute: float = _ABSOLUTE

    @classmethod
    def of(cls, given: Any) -> Tolerance:
        """From what a check says: a number, "exact", or both parts."""
        if given is None:
            return cls()
        if isinstance(given, dict):
            return cls(float(given.get("relative", 0.0)), float(given.get("absolute", 0.0)))
        return cls(0.0, 0.0 if given == "exact" else float(given))

    @property
    def wants_all_digits(self) -> bool:
        """Whether it matters what stands behind the digits that are usually shown."""
        return max(self.relative, self.absolute) < _ABSOLUTE

    def allows(self, wanted: Any, got: Any) -> bool:
        """Whether one value is the other."""
        if isinstance(wanted, float) or isinstance(got, float):
            if isinstance(wanted, (bool, str)) or isinstance(got, (bool, str)):
                return False
            both_nan = wanted != wanted and got != got  # noqa: PLR0124 - only NaN differs from itself
            return both_nan or math.isclose(got, wanted, rel_tol=self.relative, abs_tol=self.absolute)
        if isinstance(wanted, list) and isinstance(got, list):
            return len(wanted) == len(got) and all(map(self.allows, wanted, got))
        if isinstance(wanted, dict) and isinstance(got, dict):
            return all(name in got and self.allows(value, got[name]) for name, value in wanted.items())
        return type(wanted) is type(got) and bool(wanted == got)


def plain(value: Any) -> Any:
    """A message as dicts and lists of numbers, texts and truth values."""
    if hasattr(value, "get_fields_and_field_types"):
        return {name: plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, bytes):
        return list(value)
    if hasattr(value, "tolist"):  # numpy's arrays and Python's
        return plain(value.tolist())
    return [plain(one) for one in value]


def is_blank(message: Message) -> bool:
    """Whether a message is as ROS 2 makes it: nobody has filled in anything."""
    return bool(message == type(message)())


def worked_out(expected: Any, names: Mapping[str, Any]) -> Any:
    """What is expected, with its expressions worked out.

    Args:
        expected: fields and their values, of which texts are expressions; or one expression for all.
        names: plain data by name.

    Raises:
        ExpressionError: one has no value for these.
    """
    if isinstance(expected, str):
        return Expression.parse(expected).value(names)
    if isinstance(expected, dict):
        return {name: worked_out(value, names) for name, value in expected.items()}
    return expected


def in_words(check: Declaration, otherwise: str, **names: Any) -> str:
    """What the `what` of a check says in words of an input.

    Args:
        check: the check.
        otherwise: what is said where it has none.
        names: plain data by name.
    """
    return str(worked_out(check.keys["what"], names)) if "what" in check.keys else otherwise


def parameters_in(expected: Any) -> list[str]:
    """The parameters that the expressions of what is expected look up."""
    if isinstance(expected, dict):
        return list(dict.fromkeys(name for value in expected.values() for name in parameters_in(value)))
    paths = Expression.parse(expected).paths() if isinstance(expected, str) else []
    return list(dict.fromkeys(path[1] for path in paths if path[0] == PARAMETERS and len(path) > 1))


def uses_parameters(expected: Any) -> bool:
    """Whether what is expected depends on parameters."""
    return bool(parameters_in(expected))


def check_asks_the_solution(check: Declaration) -> bool:
    """Whether a check compares with what the exercise's solution answers."""
    expected = [check.keys.get("expect"), *(case["expect"] for case in check.keys.get("cases", ()))]
    return any(map(_asks_the_solution, expected))


def _asks_the_solution(expected: Any) -> bool:
    """Whether what is expected depends on what the exercise's solution answers."""
    if isinstance(expected, dict):
        return any(map(_asks_the_solution, expected.values()))
    return isinstance(expected, str) and any(path[0] == ORACLE for path in Expression.parse(expected).paths())


def differences(wanted: Any, got: Any, tolerance: Tolerance, path: str = "") -> Iterator[tuple[str, Any, Any]]:
    """The fields that are not as expected: their paths, what was wanted and what came.

    Args:
        wanted: plain data of the fields that matter.
        got: plain data of the whole message.
        tolerance: of floats.
        path: of what is compared.
    """
    if isinstance(wanted, dict) and isinstance(got, dict):
        for name, value in wanted.items():
            yield from differences(value, got.get(name, MISSING), tolerance, f"{path}.{name}" if path else name)
    elif got is MISSING or not tolerance.allows(wanted, got):
        yield path, wanted, None if got is MISSING else got


def shown(fields: Any, *, exact: bool = False) -> str:
    """A message as plain data in one line, `value=21.5, from_unit='celsius'`, nested fields with a dot.

    Args:
        fields: the plain data.
        exact: whether numbers are shown with all their digits.
    """
    told = list(_flat(fields))
    few = told if len(told) <= _FEW else [(name, value) for name, value in told if value]
    words = [_field(*one, exact=exact) for one in few]
    if len(few) < len(told):
        words.append("the rest 0" if few else "all fields 0")
    return ", ".join(words) or "an empty message"


def shown_part(fields: Any, only: Any = None, *, exact: bool = False) -> str:
    """Some fields of a message in one line, those that are 0 included.

    Args:
        fields: plain data.
        only: the fields to show, as the keys of another such data; all when None.
        exact: see `shown`.
    """
    told = list(_flat(fields, only))
    words = [_field(*one, exact=exact) for one in told[:_MOST]]
    return ", ".join([*words, f"{len(told) - _MOST} more"] if len(told) > _MOST else words) or "an empty message"


def _field(name: str, value: Any, *, exact: bool) -> str:
    return f"{name}={_value(value, exact)}" if name else _value(value, exact)


def _flat(fields: Any, only: Any = None, path: str = "") -> Iterator[tuple[str, Any]]:
    if not isinstance(fields, dict):
        yield path, fields
        return
    for name, value in fields.items():
        if not isinstance(only, dict) or name in only:
            inner = only[name] if isinstance(only, dict) else None
            yield from _flat(value, inner, f"{path}.{name}" if path else name)


def _value(value: Any, exact: bool) -> str:
    if isinstance(value, bool) or not isinstance(value, (float, str, list)):
        return repr(value)
    if isinstance(value, float):
        return repr(value) if exact or value.is_integer() else f"{value:.{_DIGITS}g}"
    if isinstance(value, str):
        return repr(value if len(value) <= _LONGEST else f"{value[:_LONGEST]}...")
    text = f"[{', '.join(_value(one, exact) for one in value[:_LONGEST])}]"
    return text if len(value) <= _LONGEST else f"{text[:-1]}, ...]"

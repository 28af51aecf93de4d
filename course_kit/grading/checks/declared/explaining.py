"""What is wrong with values that came back, as far as several of them tell it."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

from course_kit.grading.checks.declared.messages import Tolerance, differences, plain

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.diagnosis.exits import Cause
    from course_kit.ros.messages import Message

_DENORMAL = 1e-300  # an integer written into a float field arrives as one of the smallest numbers there are
_LOST = 1.0  # what is lost by //, int() or round() is less
_DECIMALS = range(1, 13)  # places to which a value may have been rounded, or cut off
_USUAL = Tolerance()  # within which a formula is the right one


class Exchanged(NamedTuple):
    """One exchange: plain data of what was sent, what was wanted, and the message that came."""

    sent: Any
    wanted: Any
    got: Message


def explained(wrong: Exchanged, of_all: Sequence[Exchanged], tolerance: Tolerance, *, floors: bool) -> Cause:
    """What is wrong with an answer.

    Args:
        wrong: the exchange with the wrong answer.
        of_all: all exchanges of the check.
        tolerance: of floats.
        floors: whether the learner's program uses `//`.
    """
    if all(one.got == type(one.got)() for one in of_all):
        return None, "What came back is as ROS 2 creates it: your callback filled in nothing."
    path, wanted, got = next(differences(wrong.wanted, plain(wrong.got), tolerance))
    if isinstance(got, float) and 0.0 < abs(got) < _DENORMAL:
        return "field.type", f"'{path}' is so close to zero because an integer was put into a float field."
    if _come_late(of_all, tolerance):
        return None, "Each answer is the right one for what was sent before it: your node answers one too late."
    if isinstance(wanted, bool) or not _is_number(wanted) or not _is_number(got):
        return None, f"{_name(path)} has to be {wanted!r} here, not {got!r}."
    return _of_numbers(path, wanted, got, _pairs(path, of_all), tolerance, floors=floors)


def _of_numbers(  # noqa: PLR0913 - all that is known of them
    path: str, wanted: float, got: float, pairs: list[tuple[Any, Any]], tolerance: Tolerance, *, floors: bool
) -> Cause:
    field = _name(path)
    if all(one == 0 for _, one in pairs) and any(one for one, _ in pairs):
        told = "a small number divided by a larger one with // is 0." if floors else f"was {field} filled in?"
        return ("math.integer_division" if floors else "math.formula"), f"Every value came back as 0: {told}"
    if got and all(tolerance.allows(-float(one), float(two)) for one, two in pairs):
        return "math.formula", f"{field} has the right size and the wrong sign."
    if _digits_are_lost(wanted, got, pairs, floors=floors):
        off = abs(got - wanted)
        told = "digits were lost in the calculation (//, int() or round())."
        return "math.integer_division", f"{field} is off by {off:.2g}: {told}"
    return "math.formula", f"{field} has to be {wanted:.10g} here, not {got:.10g}."


def _digits_are_lost(wanted: float, got: float, pairs: list[tuple[Any, Any]], *, floors: bool) -> bool:
    near = all(abs(one - two) < _LOST for one, two in pairs)
    whole = all(float(two).is_integer() for _, two in pairs)
    if near and (whole or floors) and not float(wanted).is_integer() and got != wanted:
        return True
    if all(isinstance(two, float) and _USUAL.allows(float(one), two) for one, two in pairs):
        return True
    return near and any(all(_is_rounded(one, two, places) for one, two in pairs) for places in _DECIMALS)


def _is_rounded(wanted: float, got: float, places: int) -> bool:
    """Whether a value is the wanted one, rounded or cut off after so many decimal places."""
    return math.isfinite(got) and got == round(got, places) and abs(got - wanted) < 10.0**-places


def _pairs(path: str, of_all: Sequence[Exchanged]) -> list[tuple[Any, Any]]:
    """What was wanted and what came for one field, of all exchanges in which both are numbers."""
    found = [(_at(path, one.wanted), _at(path, plain(one.got))) for one in of_all]
    return [pair for pair in found if all(map(_is_number, pair))]


def _at(path: str, fields: Any) -> Any:
    for name in path.split(".") if path else ():
        fields = fields.get(name) if isinstance(fields, dict) else None
    return fields


def _come_late(of_all: Sequence[Exchanged], tolerance: Tolerance) -> bool:
    """Whether each answer is the one before, and these differ."""
    pairs = list(itertools.pairwise(of_all))
    late = all(next(differences(one.wanted, plain(two.got), tolerance), None) is None for one, two in pairs)
    return late and any(next(differences(one.wanted, two.wanted, tolerance), None) is not None for one, two in pairs)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _name(path: str) -> str:
    return path or "the answer"

"""What a declared check sends: tables of fields, in which `{draw = [low, high]}` and `{choice = [...]}` are drawn.

The values of a check follow from the grading's seed and the check's id alone. So they stay the same when another check
is added or fails, and the exercise's own solution can be asked with the same values before the submission is started.
"""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from course_kit.grading.plain_data import Record

T = TypeVar("T")
DRAW, CHOICE, COUNT = "draw", "choice", "count"
MOST = 50  # values of one draw
_STEPS = 4  # digits of a drawn number, counted from the first of its range


def is_drawn(value: object) -> bool:
    """Whether a value of a table stands for drawn ones."""
    return isinstance(value, dict) and (DRAW in value or CHOICE in value)


def problem_of(value: Record) -> str:
    """Why nothing can be drawn, or nothing."""
    more = set(value) - {DRAW, CHOICE, COUNT}
    if more or (DRAW in value) == (CHOICE in value):
        return "A drawn value is {draw = [low, high]} or {choice = [one, another]}, each with a count if wanted."
    count = value.get(COUNT, 1)
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= MOST:
        return f"'count' is a whole number from 1 to {MOST}, not {count!r}."
    if CHOICE in value:
        return "" if isinstance(value[CHOICE], list) and value[CHOICE] else "'choice' is a list with something in it."
    span = value[DRAW]
    numbers = isinstance(span, list) and all(
        isinstance(one, (int, float)) and not isinstance(one, bool) for one in span
    )
    if not numbers or len(span) != 2 or not all(map(math.isfinite, span)) or not span[0] < span[1]:  # noqa: PLR2004
        return f"'draw' is the lowest and the highest number, such as [-1.0, 1.0], not {span!r}."
    return ""


def examples(value: Record) -> Sequence[Any]:
    """Values that may be drawn, to look whether a field takes them."""
    return list(value[CHOICE] if CHOICE in value else value[DRAW])


def drawn(tables: Sequence[Record], seed: int, check: str) -> list[Record]:
    """The tables with their values drawn; one with a `count` is there so many times.

    Args:
        tables: as they are written.
        seed: of the grading.
        check: the check's id.
    """
    source = random.Random(f"{seed} {check}")  # noqa: S311 - test values, not secrets
    return [made for table in tables for made in _drawn(table, source)]


def count_of(table: Record) -> int:
    """How many tables are made of one with drawn values; 1 for one whose counts are none."""
    counts = [one.get(COUNT, 1) for one in _draws(table)]
    return max([1, *(count for count in counts if isinstance(count, int))])


def in_turns(made: Sequence[T], counts: Sequence[int]) -> list[T]:
    """What was made of several tables, one of each in turn, then the next of each.

    Args:
        made: in the order of the tables.
        counts: how many were made of each.
    """
    places, start = [], 0
    for table, count in enumerate(counts):
        places += [(number, table, start + number) for number in range(count)]
        start += count
    return [made[place] for _, _, place in sorted(places)]


def _drawn(table: Record, source: random.Random) -> Iterator[Record]:
    count = count_of(table)
    values = {id(one): _values(one, count, source) for one in _draws(table)}
    for number in range(count):
        yield {name: _filled(value, values, number) for name, value in table.items()}


def _draws(value: Any) -> Iterator[Record]:
    if is_drawn(value):
        yield value
        return
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    for part in parts:
        yield from _draws(part)


def _filled(value: Any, values: dict[int, list[Any]], number: int) -> Any:
    if is_drawn(value):
        return values[id(value)][number]
    if isinstance(value, dict):
        return {name: _filled(part, values, number) for name, part in value.items()}
    return [_filled(part, values, number) for part in value] if isinstance(value, list) else value


def _values(drawing: Record, count: int, source: random.Random) -> list[Any]:
    """So many values; of a range one from each of as many equal parts: a mistake costs the same with any seed."""
    if CHOICE in drawing:
        rounds = -(-count // len(drawing[CHOICE]))
        values = [one for _ in range(rounds) for one in source.sample(drawing[CHOICE], len(drawing[CHOICE]))][:count]
    else:
        low, high = drawing[DRAW]
        parts = [
            source.uniform(low + (high - low) * n / count, low + (high - low) * (n + 1) / count) for n in range(count)
        ]
        whole = isinstance(low, int) and isinstance(high, int)
        values = [min(max(round(one) if whole else _shortened(one, high - low), low), high) for one in parts]
        source.shuffle(values)
    return values


def _shortened(value: float, width: float) -> float:
    """A number with no more digits than its range needs: people read it."""
    return round(value, max(_STEPS - 1 - math.floor(math.log10(width)), 0))

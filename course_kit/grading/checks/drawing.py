"""Values that are drawn afresh for each step of a conversation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import random
    from collections.abc import Callable


@dataclass(frozen=True)
class Draw:
    """A value that is drawn for each step."""

    options: tuple[Any, ...]
    make: Callable[[random.Random], Any] | None = None


def either(*options: Any) -> Draw:
    """One of these: each comes once before one comes a second time, so that no edge is left to chance.

    Args:
        options: values, or other drawings.

    Example:
        >>> @rule(value=either(0.0, 32.0, math.nan, between(-200.0, 500.0)))
        ... def convert(self, node, value): ...
    """
    return Draw(options)


def between(low: float, high: float) -> Draw:
    """A number in a range, both ends included; a whole one for two whole ends.

    Example:
        >>> @rule(order=between(1, 9))
        ... def count(self, node, order): ...
    """
    whole = isinstance(low, int) and isinstance(high, int)
    return Draw((), lambda rng: rng.randint(int(low), int(high)) if whole else rng.uniform(low, high))


def drawn(make: Callable[[random.Random], Any]) -> Draw:
    """What a function makes of a random.Random.

    Example:
        >>> @rule(values=drawn(lambda rng: [rng.uniform(-1, 1) for _ in range(3)]))
        ... def several(self, node, values): ...
    """
    return Draw((), make)


def drawn_values(value: Any, rng: random.Random) -> Any:
    """A list, a dict or a value in which each drawing is replaced by what it gives.

    Args:
        value: may hold drawings.
        rng: what they draw from.
    """
    if isinstance(value, dict):
        return {name: drawn_values(one, rng) for name, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [drawn_values(one, rng) for one in value]
    if not isinstance(value, Draw):
        return value
    return value.make(rng) if value.make else drawn_values(rng.choice(value.options), rng)

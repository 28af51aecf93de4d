"""Parameters in a notebook, in words: what a node has, what came of setting it, what may be set."""

from __future__ import annotations

import re
from typing import Any

from course_kit.ros.parameters import Descriptor


class Values(dict[str, Any]):
    """Values by name that print one a line."""

    def __repr__(self) -> str:
        return "\n".join(f"{name}: {value!r}" for name, value in self.items()) or "no parameters"

    __str__ = __repr__


class Outcome:
    """What came of setting parameters; true if all were set."""

    def __init__(self, node: str, values: dict[str, object], reasons: dict[str, str], *, atomically: bool) -> None:
        self.node = node
        self.values = values
        self.reasons = reasons
        self._atomically = atomically

    @property
    def successful(self) -> bool:
        """Whether every parameter was set."""
        return not self.reasons

    @property
    def events(self) -> int:
        """How many messages on /parameter_events tell of it."""
        return int(self.successful) if self._atomically else len(self.values) - len(self.reasons)

    def __bool__(self) -> bool:
        return self.successful

    def __repr__(self) -> str:
        if self._atomically and self.reasons:
            reason = next(iter(self.reasons.values()))
            return f"nothing was set, because one value was refused: {reason}"
        return "\n".join(self._line(name) for name in self.values)

    def _line(self, name: str) -> str:
        value = self.values[name]
        if name not in self.reasons:
            return f"{name}: set to {value!r}"
        reason = self.reasons[name]
        return f"{name}: {value!r} was refused: {reason}{_hint(value, reason)}"


class Descriptors(list[Descriptor]):
    """Descriptors that print one after the other."""

    def __repr__(self) -> str:
        return "\n".join(str(one) for one in self) or "no parameters"

    __str__ = __repr__


def _hint(value: object, reason: str) -> str:
    """For the slip everybody makes: 1 is an integer, and a double does not take it."""
    if type(value) is int and re.match(r"wrong parameter type.*double", reason, re.IGNORECASE):
        return f". {value} is an integer: write {float(value)}"
    return ""

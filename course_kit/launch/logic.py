"""Substitutions that compare and choose; what they say is "true" or "false", as conditions want it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.launch.conditions import truth
from course_kit.launch.substitutions import Substitution, Text, as_text

if TYPE_CHECKING:
    from course_kit.launch.context import LaunchContext


class EqualsSubstitution(Substitution):
    """Whether two texts are equal."""

    def __init__(self, left: Text | None, right: Text | None) -> None:
        self._left, self._right = left, right

    def perform(self, context: LaunchContext) -> str:
        """Say "true" or "false"."""
        return str(as_text(self._left, context) == as_text(self._right, context)).lower()


class NotEqualsSubstitution(EqualsSubstitution):
    """Whether two texts differ."""

    def perform(self, context: LaunchContext) -> str:
        """Say "true" or "false"."""
        return "false" if super().perform(context) == "true" else "true"


class NotSubstitution(Substitution):
    """The opposite of true or false."""

    def __init__(self, value: Text) -> None:
        self._value = value

    def perform(self, context: LaunchContext) -> str:
        """Say "true" or "false"."""
        return str(not truth(self._value, context)).lower()


class AndSubstitution(Substitution):
    """Whether both are true."""

    def __init__(self, left: Text, right: Text) -> None:
        self._left, self._right = left, right

    def perform(self, context: LaunchContext) -> str:
        """Say "true" or "false"."""
        return str(truth(self._left, context) and truth(self._right, context)).lower()


class OrSubstitution(AndSubstitution):
    """Whether one of both is true."""

    def perform(self, context: LaunchContext) -> str:
        """Say "true" or "false"."""
        return str(truth(self._left, context) or truth(self._right, context)).lower()


class IfElseSubstitution(Substitution):
    """One of two texts."""

    def __init__(self, condition: Text, if_value: Text = "", else_value: Text = "") -> None:
        self._condition, self._values = condition, (else_value, if_value)

    def perform(self, context: LaunchContext) -> str:
        """The text."""
        return as_text(self._values[truth(self._condition, context)], context)

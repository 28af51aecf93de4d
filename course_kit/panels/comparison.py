"""Measured numbers as bars: what was measured is shown, and only its order is stored with the notebook."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import ipywidgets

from course_kit.panels.base import Panel
from course_kit.text.templates import render

if TYPE_CHECKING:
    from collections.abc import Mapping

_TEMPLATE = Path(__file__).with_name("comparison.html")


class Comparison(Panel):
    """Numbers side by side."""

    def __init__(self, title: str, values: Mapping[str, float], unit: str) -> None:
        if not values or not all(math.isfinite(value) and value >= 0 for value in values.values()):
            raise ValueError(f"compare needs at least one number, finite and not below zero; got {dict(values)!r}.")
        super().__init__(title)
        self._title = title
        self._order = sorted(values, key=lambda name: values[name])
        drawn = render(_TEMPLATE, title=title, values=values, unit=unit, longest=max(values.values()) or 1.0)
        self._drawn = drawn
        self.widget = ipywidgets.HTML(str(drawn))

    def still(self) -> str:
        """The bars, which do not move anyway."""
        return str(self._drawn)

    def describe(self) -> str:
        """The order without the numbers, which no two runs share."""
        return f"{self._title}, smallest first: {', '.join(self._order)}."

"""Measured numbers as bars: what was measured is shown, and only its order is stored with the notebook."""

from __future__ import annotations

import math
from html import escape
from typing import TYPE_CHECKING

import ipywidgets

from course_kit.panels.base import Panel

if TYPE_CHECKING:
    from collections.abc import Mapping

_STYLE = (
    "display:grid;grid-template-columns:max-content minmax(8em,24em) max-content;gap:.3em .9em;align-items:center;"
    "max-width:52em"
)
_BAR = "height:.9em;min-width:2px;background:var(--jp-brand-color1,#1976d2)"


class Comparison(Panel):
    """Numbers side by side.

    Args:
        title: what was measured; a panel of the same title is replaced.
        values: by what they belong to; finite, none below zero.
        unit: of the values, such as "ms".

    Raises:
        ValueError: there is no value, or one is no length for a bar.
    """

    def __init__(self, title: str, values: Mapping[str, float], unit: str) -> None:
        if not values or not all(math.isfinite(value) and value >= 0 for value in values.values()):
            raise ValueError(f"compare needs at least one number, finite and not below zero; got {dict(values)!r}.")
        super().__init__(title)
        self._title = title
        self._order = sorted(values, key=lambda name: values[name])
        self._html = ipywidgets.HTML(_drawn(title, values, unit))

    @property
    def widget(self) -> ipywidgets.HTML:
        """The bars, each with its number beside it."""
        return self._html

    def describe(self) -> str:
        """The order without the numbers, which no two runs share."""
        return f"{self._title}, smallest first: {', '.join(self._order)}."


def _drawn(title: str, values: Mapping[str, float], unit: str) -> str:
    longest = max(values.values()) or 1.0
    rows = "".join(
        f'<span>{escape(name)}</span><div aria-hidden="true"><div style="{_BAR};width:{100 * value / longest:.1f}%">'
        f"</div></div><span>{value:.3g} {escape(unit)}</span>"
        for name, value in values.items()
    )
    caption = f"<figcaption>{escape(title)}</figcaption>"
    return f'<figure style="margin:.5em 0">{caption}<div style="{_STYLE}">{rows}</div></figure>'

"""A plot as a still picture: plotting.js draws the same in a page that is alive."""

from __future__ import annotations

import math
from itertools import pairwise
from statistics import median
from typing import TYPE_CHECKING

from course_kit.panels.still import drawn

if TYPE_CHECKING:
    from collections.abc import Sequence

_LEFT, _RIGHT, _TOP, _BOTTOM = 58, 626, 12, 200  # of the frame, in the template's user units
_LEAST_GAP = 0.5  # seconds without a message that the line never goes across


def plot_svg(samples: Sequence[Sequence[float]], span: float, field: str) -> str:
    """The drawing as an `svg` element, which templates take as it is."""
    finite = [value for _, value in samples if math.isfinite(value)]
    marks = _marks(*_range(finite))
    low, high = marks[0], marks[-1]
    now = samples[-1][0] if samples else 0.0

    def x_of(seconds: float) -> float:
        return round(_LEFT + (seconds + span) / span * (_RIGHT - _LEFT), 1)

    def y_of(value: float) -> float:
        return round(_TOP + (high - value) / (high - low) * (_BOTTOM - _TOP), 1)

    gap = max([_LEAST_GAP, *([8 * median(b[0] - a[0] for a, b in pairwise(samples))] if len(samples) > 1 else [])])
    line, before = "", -math.inf
    for at, value in samples:
        if math.isfinite(value):
            line += f"{'L' if at - before <= gap else 'M'}{x_of(at - now)} {y_of(value)}"
            before = at
        else:
            before = -math.inf
    said = f"The latest value is {finite[-1]:.4g}." if finite else "No message yet."
    return drawn(
        "still_plot.svg",
        summary=f"{field} against time. {said}",
        field=field,
        rows=[(y_of(mark), f"{mark:.4g}") for mark in marks],
        columns=[(x_of(mark), f"{mark:.4g}") for mark in _marks(-span, 0.0) if mark >= -span],
        line=line,
    )


def _range(values: Sequence[float]) -> tuple[float, float]:
    """What the vertical axis has to cover; never nothing."""
    low, high = (min(values), max(values)) if values else (0.0, 1.0)
    if high > low:
        return low, high
    room = abs(low) * 0.2 or 1.0
    return low - room, high + room


def _marks(low: float, high: float) -> list[float]:
    """Round numbers that cover a stretch in about four steps."""
    exact = (high - low) / 4
    power = 10.0 ** math.floor(math.log10(exact))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= exact * 0.999)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    return [float(f"{number * step:.12g}") for number in range(first, last + 1)]

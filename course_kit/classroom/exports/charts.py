"""The class page's drawings: SVG with every number written beside its bar."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.classroom.exports.texts import number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.classroom.exports.counts import Bar

_WIDTH, _HEIGHT = 560, 210
_TOP, _BOTTOM, _SIDE = 40, 44, 8  # room for the numbers and the pass mark's name; for the axis


def histogram(bars: Sequence[Bar], pass_mark: float, name: str) -> str:
    """A distribution of scores with the pass mark.

    Args:
        bars: from the lowest score to full marks.
        pass_mark: in points.
        name: what a screen reader says of it, escaped.
    """
    most = max((bar.count for bar in bars), default=0) or 1
    step = (_WIDTH - 2 * _SIDE) / len(bars)
    drawn = "".join(_bar(bar, _SIDE + place * step, step, most, bar.low >= pass_mark) for place, bar in enumerate(bars))
    width = bars[1].low - bars[0].low
    mark = _SIDE + pass_mark / width * step
    side, anchor = (-5, "end") if mark > _WIDTH / 3 else (5, "start")
    axis = _HEIGHT - _BOTTOM
    return (
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{name}">'
        f'{drawn}<path class="axis" d="M{_SIDE} {axis}H{_WIDTH - _SIDE}"/>'
        f'<path class="mark" d="M{mark:.1f} {_TOP - 22}V{axis}"/>'
        f'<text class="mark-name" style="text-anchor:{anchor}" x="{mark + side:.1f}" y="{_TOP - 26}">'
        f"pass mark {number(pass_mark)}</text>"
        f'<text class="unit" x="{_WIDTH / 2:.0f}" y="{_HEIGHT - 6}">points</text></svg>'
    )


def hatching() -> str:
    """The pattern of bars below the pass mark; once in a page, before its histograms."""
    return (
        '<svg class="defs" width="0" height="0" aria-hidden="true"><pattern id="hatch" width="6" height="6" '
        'patternUnits="userSpaceOnUse" patternTransform="rotate(45)"><rect class="below" width="6" height="6"/>'
        '<path class="hatch" d="M0 0V6"/></pattern></svg>'
    )


def _bar(bar: Bar, left: float, step: float, most: int, reached: bool) -> str:
    axis = _HEIGHT - _BOTTOM
    height = (axis - _TOP) * bar.count / most
    centre = left + step / 2
    kind = 'class="reached"' if reached else 'fill="url(#hatch)"'
    drawn = (
        f'<rect {kind} x="{left + step * 0.1:.1f}" y="{axis - height:.1f}" width="{step * 0.8:.1f}" '
        f'height="{height:.1f}" rx="2"/><text x="{centre:.1f}" y="{axis - height - 5:.1f}">{bar.count}</text>'
        if bar.count
        else ""
    )
    return f'{drawn}<text class="label" x="{centre:.1f}" y="{axis + 17}">{bar.label}</text>'


def meter(part: int, whole: int) -> str:
    """A bar for a share; the number stands beside it in the table."""
    width = 100 * part / whole if whole else 0.0
    return f'<span class="meter" aria-hidden="true"><span style="width:{width:.1f}%"></span></span>'

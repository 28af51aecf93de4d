"""The one lab of this process."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab


class _Current:
    lab: Lab | None = None


def current() -> Lab:
    """The lab of this process, made on first use."""
    if _Current.lab is None:
        from course_kit.lab.runtime.core import Lab

        _Current.lab = Lab()
    return _Current.lab


def use(lab: Lab | None) -> Lab | None:
    """Make another lab the current one; None for a new one on next use."""
    before, _Current.lab = _Current.lab, lab
    return before

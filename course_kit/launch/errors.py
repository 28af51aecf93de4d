"""What goes wrong with a launch file, as a sentence."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


class LaunchError(Exception):
    """A launch file cannot be run as it is."""


def refuse(owner: str, options: Iterable[str]) -> None:
    """Refuse options that launch has and the course kit has not.

    Raises:
        LaunchError: there are some.
    """
    if options:
        names = ", ".join(sorted(options))
        raise LaunchError(f"{owner}({names}=...) is not part of the course kit's subset of launch.")

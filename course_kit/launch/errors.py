"""What goes wrong with a launch file, as a sentence."""

from __future__ import annotations

from typing import Any


class LaunchError(Exception):
    """A launch file cannot be run as it is."""


def refuse(owner: str, options: dict[str, Any]) -> None:
    """Refuse options that launch has and the course kit has not.

    Raises:
        LaunchError: there are some.
    """
    if options:
        names = ", ".join(sorted(options))
        raise LaunchError(f"{owner}({names}=...) is not part of the course kit's subset of launch.")

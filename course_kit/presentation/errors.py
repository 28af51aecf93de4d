"""What can keep a notebook from being presented, as sentences for people."""

from __future__ import annotations


class PresentationError(RuntimeError):
    """It cannot be presented; the text is for the speaker."""

"""What cannot be said to ROS."""

from __future__ import annotations


class BadFieldError(ValueError):
    """A field was given by a wrong name, or it or a parameter with a value it cannot take; the message says which."""

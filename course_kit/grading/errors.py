"""What keeps a grading from taking place, said for the person who asked for it."""

from __future__ import annotations


class GradingError(RuntimeError):
    """The grading could not be done: usage, a missing file, or a broken installation. Never the learner's fault."""

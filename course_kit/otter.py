"""What test files for Otter-Grader import, so that it stays where it is: see `integrations.otter`."""

from course_kit.integrations.otter import check

__all__ = ["check"]

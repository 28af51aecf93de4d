"""What the test cells of an nbgrader assignment import, so that it stays where it is: see `integrations.nbgrader`."""

from course_kit.integrations.nbgrader import points

__all__ = ["points"]

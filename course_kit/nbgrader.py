"""What the test cells of an nbgrader assignment import, so that it stays here: see `integrations.grade_magics`."""

from course_kit.integrations.grade_magics import points

__all__ = ["points"]

"""`course-kit prove`: what would a grader let through?

It makes every small mistake in an exercise's solution, grades each, and names those that get full marks.
"""

"""`course-kit prove`: what would a grader let through?

It makes every small mistake in an exercise's solution, grades each, and names those that get full marks. The mistakes
are our own, not those of mutmut or cosmic-ray: these change a package and run its unit tests, while ours are graded
over the wire, and half of them are mistakes with ROS.
"""

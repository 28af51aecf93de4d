"""`python -m course_kit.ros2cli`: always the course kit's own command, never a real one."""

import sys

from course_kit.ros2cli.cli import run_program

sys.exit(run_program())

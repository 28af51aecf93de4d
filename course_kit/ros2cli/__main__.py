"""`python -m course_kit.ros2cli`: always the course kit's own command, never a real one."""

from course_kit.ros2cli.cli import leave_process, run_program

leave_process(run_program())

"""The commands that lessons show, one by one, against the lessons' own programs."""

from __future__ import annotations

from .commands import OURS, PROGRAMS, Ros2, interrupt, lines_until


def test_the_lessons_launch_file(ros2: Ros2) -> None:
    launch = ros2.begin(*OURS, "launch", str(PROGRAMS / "parameter_node.launch.py"))
    shown = "".join(lines_until(launch, "Wheel diameter"))
    assert "[parameter_node-1]: process started" in shown
    assert ros2("param", "get", "/parameter_node", "robot_name").stdout == "String value is: turtlebot4\n"
    assert ros2("param", "get", "/parameter_node", "max_velocity").stdout == "Double value is: 2.0\n"
    interrupt(launch)
    assert launch.returncode == 0


def test_run_finds_the_lessons_program(ros2: Ros2) -> None:
    ros2.environ["COURSE_KIT_PACKAGE_PATH"] = str(PROGRAMS.parent)
    program = ros2.begin(*OURS, "run", "lesson_programs", "parameter_node", "--ros-args", "-p", "robot_name:=r2d2")
    assert program.stderr is not None
    assert "Robot: r2d2" in program.stderr.readline()

"""The capstone, solved: starts battery, door and carrier with robot.yaml; `speed:=0.8` sets the carrier's speed."""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

FOLDER = Path(__file__).parent
SETTINGS = str(FOLDER / "robot.yaml")


def generate_launch_description() -> LaunchDescription:
    """The three programs, each with its part of robot.yaml."""
    speed = ParameterValue(LaunchConfiguration("speed"), value_type=float)
    return LaunchDescription(
        [
            DeclareLaunchArgument("speed", default_value="1.0", description="m/s"),
            Node(executable=str(FOLDER / "battery.py"), parameters=[SETTINGS], output="screen"),
            Node(executable=str(FOLDER / "door.py"), parameters=[SETTINGS], output="screen"),
            Node(
                executable=str(FOLDER / "carrier.py"),
                parameters=[SETTINGS, {"speed_mps": speed}],
                output="screen",
            ),
        ]
    )

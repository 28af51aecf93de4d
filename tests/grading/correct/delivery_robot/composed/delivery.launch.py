"""Starts one process with the three nodes."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    speed = {"speed_mps": LaunchConfiguration("speed")}
    return LaunchDescription(
        [
            DeclareLaunchArgument("speed", default_value="0.5"),
            Node(executable="robot.py", parameters=["robot.yaml", speed]),
        ]
    )

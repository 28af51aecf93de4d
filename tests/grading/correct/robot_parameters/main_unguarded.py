"""main called without a guard; ranges in descriptors, and a fallback with a warning for values given at the start."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64, String

RANGES = {"max_velocity": (1e-9, 5.0), "wheel_diameter": (0.01, 1.0)}


class VelocityLimiter(Node):
    def __init__(self):
        super().__init__("velocity_limiter")
        self.declare_parameter("robot_name", "default_robot")
        self.declare_parameter("enabled", True)
        for name, default in (("max_velocity", 1.0), ("wheel_diameter", 0.1)):
            given = self.declare_parameter(name, default).value
            lowest, highest = RANGES[name]
            if not lowest <= given <= highest:
                self.get_logger().warning(f"{name}={given} is outside {lowest}..{highest}, taking {default}")
                self.set_parameters([Parameter(name, value=default)])
        if not self.get_parameter("robot_name").value:
            self.get_logger().warning("robot_name is empty, taking default_robot")
            self.set_parameters([Parameter("robot_name", value="default_robot")])
        self.add_on_set_parameters_callback(self.on_set)
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.wheel_publisher = self.create_publisher(Float64, "wheel_speed", 10)
        self.status_publisher = self.create_publisher(String, "status", 10)
        self.create_timer(0.5, self.publish_status)
        self.create_subscription(Twist, "cmd_vel_in", self.callback, 10)

    def on_set(self, parameters):
        reasons = []
        for parameter in parameters:
            if parameter.name in RANGES:
                lowest, highest = RANGES[parameter.name]
                if not lowest <= parameter.value <= highest:
                    reasons.append(f"{parameter.name} must lie between {lowest} and {highest}")
            elif parameter.name == "robot_name" and not parameter.value:
                reasons.append("robot_name is empty")
        return SetParametersResult(successful=not reasons, reason=", ".join(reasons))

    def callback(self, message):
        velocity = self.get_parameter("max_velocity").get_parameter_value().double_value
        diameter = self.get_parameter("wheel_diameter").get_parameter_value().double_value
        result = Twist(linear=message.linear, angular=message.angular)
        result.linear.x = min(velocity, max(-velocity, message.linear.x))
        if not self.get_parameter("enabled").get_parameter_value().bool_value:
            result = Twist()
        self.publisher.publish(result)
        speed = Float64()
        speed.data = result.linear.x / (diameter / 2)
        self.wheel_publisher.publish(speed)

    def publish_status(self):
        status = String()
        status.data = (
            self.get_parameter("robot_name").value + ": " + str(self.get_parameter("max_velocity").value) + " m/s"
        )
        self.status_publisher.publish(status)


def main():
    rclpy.init()
    rclpy.spin(VelocityLimiter())


main()

"""The textbook way: a callback that judges, values read where they are used, main behind its guard."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from std_msgs.msg import Float64, String


class VelocityLimiter(Node):
    def __init__(self):
        super().__init__("velocity_limiter")
        self.add_on_set_parameters_callback(self.judge)
        for name, default in (
            ("robot_name", "default_robot"),
            ("max_velocity", 1.0),
            ("wheel_diameter", 0.1),
            ("enabled", True),
        ):
            self.declare_parameter(name, default)
        self.limited = self.create_publisher(Twist, "/cmd_vel", 10)
        self.wheel = self.create_publisher(Float64, "/wheel_speed", 10)
        self.line = self.create_publisher(String, "/status", 10)
        self.create_subscription(Twist, "/cmd_vel_in", self.on_command, 10)
        self.create_timer(0.5, self.on_timer)

    def judge(self, parameters):
        for parameter in parameters:
            if parameter.name == "robot_name" and parameter.value == "":
                return SetParametersResult(successful=False, reason="robot_name: leer ist nicht erlaubt")
            if parameter.name == "max_velocity" and not (0 < parameter.value <= 5):
                return SetParametersResult(successful=False, reason="max_velocity: 0 < v <= 5 m/s")
            if parameter.name == "wheel_diameter" and not (0.01 <= parameter.value <= 1):
                return SetParametersResult(successful=False, reason="wheel_diameter: 0.01 .. 1 m")
        return SetParametersResult(successful=True)

    def value(self, name):
        return self.get_parameter(name).value

    def on_command(self, command):
        out = Twist()
        if self.value("enabled"):
            out = command
            if abs(out.linear.x) > self.value("max_velocity"):
                out.linear.x = self.value("max_velocity") * (1.0 if out.linear.x > 0 else -1.0)
        self.limited.publish(out)
        self.wheel.publish(Float64(data=2.0 * out.linear.x / self.value("wheel_diameter")))

    def on_timer(self):
        self.line.publish(String(data="{}: {} m/s".format(self.value("robot_name"), self.value("max_velocity"))))


def main(args=None):
    rclpy.init(args=args)
    node = VelocityLimiter()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()

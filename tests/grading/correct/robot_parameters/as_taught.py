# As the lessons teach it, and short: the slips that are named after a diagnosis are made from it.
import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from std_msgs.msg import Float64, String


def problem(parameter):
    name, value = parameter.name, parameter.value
    if name == "robot_name" and not value:
        return "robot_name must not be empty"
    if name == "max_velocity" and not 0.0 < value <= 5.0:
        return "max_velocity must be above 0.0 and at most 5.0"
    if name == "wheel_diameter" and not 0.01 <= value <= 1.0:
        return "wheel_diameter must be between 0.01 and 1.0"
    return ""


class VelocityLimiter(Node):
    def __init__(self):
        super().__init__("velocity_limiter")
        self.add_on_set_parameters_callback(self.judge)
        self.declare_parameter("robot_name", "default_robot")
        self.declare_parameter("max_velocity", 1.0)
        self.declare_parameter("wheel_diameter", 0.1)
        self.declare_parameter("enabled", True)
        self.cmd_vel = self.create_publisher(Twist, "cmd_vel", 10)
        self.wheel_speed = self.create_publisher(Float64, "wheel_speed", 10)
        self.status = self.create_publisher(String, "status", 10)
        self.create_subscription(Twist, "cmd_vel_in", self.limit, 10)
        self.create_timer(0.5, self.tell_status)

    def judge(self, parameters):
        for parameter in parameters:
            reason = problem(parameter)
            if reason:
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def limit(self, command):
        limited = Twist()
        if self.get_parameter("enabled").value:
            limited = command
            highest = self.get_parameter("max_velocity").value
            limited.linear.x = max(-highest, min(highest, command.linear.x))
        self.cmd_vel.publish(limited)
        diameter = self.get_parameter("wheel_diameter").value
        self.wheel_speed.publish(Float64(data=limited.linear.x / (diameter / 2.0)))

    def tell_status(self):
        name = self.get_parameter("robot_name").value
        highest = self.get_parameter("max_velocity").value
        self.status.publish(String(data=f"{name}: {highest} m/s"))


def main():
    rclpy.init()
    node = VelocityLimiter()
    rclpy.spin(node)


if __name__ == "__main__":
    main()

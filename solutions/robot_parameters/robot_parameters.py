"""Exercise 3, solved: a node that limits velocities, and is set by parameters while it runs."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64, String

STATUS_PERIOD = 0.5  # seconds


def between(lowest: float, highest: float, description: str) -> ParameterDescriptor:
    """A descriptor with a range: rclpy refuses what lies outside, and tools can show it."""
    limits = FloatingPointRange(from_value=lowest, to_value=highest)
    return ParameterDescriptor(description=description, floating_point_range=[limits])


class VelocityLimiter(Node):
    """Passes commands from /cmd_vel_in on to /cmd_vel, no faster than max_velocity."""

    def __init__(self) -> None:
        super().__init__("velocity_limiter")
        self.cmd_vel = self.create_publisher(Twist, "cmd_vel", 10)
        self.wheel_speed = self.create_publisher(Float64, "wheel_speed", 10)
        self.status = self.create_publisher(String, "status", 10)
        # Before the declarations, so that a value given at the start is judged as well.
        self.add_on_set_parameters_callback(self.judge)
        self.declare_parameter("robot_name", "default_robot")
        self.declare_parameter("max_velocity", 1.0, between(0.0, 5.0, "greatest speed, m/s"))
        self.declare_parameter("wheel_diameter", 0.1, between(0.01, 1.0, "diameter of a wheel, m"))
        self.declare_parameter("enabled", True)
        self.create_subscription(Twist, "cmd_vel_in", self.limit, 10)
        self.create_timer(STATUS_PERIOD, self.tell_status)

    def judge(self, parameters: list[Parameter]) -> SetParametersResult:
        """Refuse what a range cannot express. Nothing is kept here: the value is read where it is used."""
        for parameter in parameters:
            if parameter.name == "robot_name" and not parameter.value:
                return SetParametersResult(successful=False, reason="robot_name must not be empty")
            if parameter.name == "max_velocity" and not 0.0 < parameter.value < math.inf:
                reason = f"max_velocity must be above 0.0 and at most 5.0, not {parameter.value}"
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def limit(self, command: Twist) -> None:
        """Publish one command, limited, and the speed of the wheels that belongs to it."""
        if self.get_parameter("enabled").value:
            highest = self.get_parameter("max_velocity").value
            command.linear.x = min(max(command.linear.x, -highest), highest)
        else:
            command = Twist()
        radius = self.get_parameter("wheel_diameter").value / 2.0
        self.cmd_vel.publish(command)
        self.wheel_speed.publish(Float64(data=command.linear.x / radius))

    def tell_status(self) -> None:
        """Publish who this is and how fast it may go."""
        name = self.get_parameter("robot_name").value
        highest = self.get_parameter("max_velocity").value
        self.status.publish(String(data=f"{name}: {highest} m/s"))


def main() -> None:
    """Run the node until Ctrl-C; a bad value given at the start ends it with one clear line."""
    rclpy.init()
    try:
        rclpy.spin(VelocityLimiter())
    except (InvalidParameterTypeException, InvalidParameterValueException) as problem:
        raise SystemExit(f"velocity_limiter cannot start: {problem}") from None
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

"""Exercise 3: a node that limits velocities, and is set by parameters while it runs.

The names and types of node and topics are right already; keep them. The rest is yours.

parameter       type    default        valid
robot_name      string  default_robot  not empty
max_velocity    double  1.0            0.0 < v <= 5.0, finite     m/s
wheel_diameter  double  0.1            0.01 .. 1.0                m
enabled         bool    true
"""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Float64, String


class VelocityLimiter(Node):
    """Passes commands from /cmd_vel_in on to /cmd_vel, no faster than max_velocity."""

    def __init__(self):
        super().__init__("velocity_limiter")
        self.cmd_vel = self.create_publisher(Twist, "cmd_vel", 10)
        self.wheel_speed = self.create_publisher(Float64, "wheel_speed", 10)
        self.status = self.create_publisher(String, "status", 10)
        # Declare the four parameters here. How will an invalid value be refused?
        self.create_subscription(Twist, "cmd_vel_in", self.limit, 10)
        self.create_timer(0.5, self.tell_status)

    def limit(self, command):
        """Publish one command, limited, on self.cmd_vel, and the speed of the wheels on self.wheel_speed.

        command.linear.x  m/s; between -max_velocity and +max_velocity when you publish it
        the other fields  stay as they are
        wheel speed       rad/s = published linear.x / (wheel_diameter / 2)

        With enabled false everything is 0.
        """
        # Your code goes here.

    def tell_status(self):
        """Publish "<robot_name>: <max_velocity> m/s" on self.status."""
        # Your code goes here.


def main():
    rclpy.init()
    node = VelocityLimiter()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

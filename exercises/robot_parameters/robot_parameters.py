"""Exercise 3: a node that limits velocities, and is set by parameters while it runs.

The names and types of node and topics are right already; keep them. The rest is yours.

parameter       type    default        valid
robot_name      string  default_robot  not empty
max_velocity    double  1.0            0.0 < v <= 5.0, finite     m/s
wheel_diameter  double  0.1            0.01 .. 1.0                m
enabled         bool    true                                   false: all is 0

topic        type
cmd_vel_in   geometry_msgs/msg/Twist   what somebody wants
cmd_vel      geometry_msgs/msg/Twist   the same, linear.x limited to +-max_velocity; all other fields stay
wheel_speed  std_msgs/msg/Float64      rad/s = published linear.x / (wheel_diameter / 2)
status       std_msgs/msg/String       twice a second: "default_robot: 1.0 m/s", robot_name and max_velocity

- A command brings exactly one message on cmd_vel and one on wheel_speed, within 3 s, in any order, and none later.
- The number in the status line may be written in any way, but is not rounded. On average a line comes every 0.42 to
  0.6 s.
- Topics connect to a reliable, volatile end, the default. A queue may have any depth: a command is sent only after the
  one before was answered.
- A change acts on the next message.
- An invalid value is refused and the old one stays. The reason names the parameter and gives an end of its range in
  numbers: "max_velocity must be above 0.0 and at most 5.0". What rclpy itself says of a range will do. For robot_name
  the name is enough.
- max_velocity 0.0 is refused; 5.0 is valid, and so are wheel_diameter 0.01 and 1.0. Outside of the ranges no test comes
  closer than 0.0001.
- A value of another type is refused, an integer for a double too, and so is a parameter that is not declared. No reason
  is needed there.
- When a valid and an invalid value are set atomically, nothing changes.
- Values given at the start count: --ros-args -p max_velocity:=2.5, or a parameter file. An invalid one either stops the
  node with an error: the program ends, and its output names the parameter (a traceback may do that). Or the default
  replaces it, with a warning: your logger's warning(), or any output that names the parameter.

More nodes, topics and parameters are allowed. The grader runs this file as a program, five times: how it is built
inside is up to you, but let rclpy.init() see the arguments. Without a `main` that is called, it makes
VelocityLimiter(), without arguments, and spins it on a MultiThreadedExecutor with four threads or more. The node has
to be there within 5 s of each start, after at most 2 s of computing.
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

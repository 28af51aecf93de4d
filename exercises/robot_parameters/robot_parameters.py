"""Exercise 3: a node that limits velocities, and is set by parameters while it runs.

The names and types of node and topics are right already; keep them. The rest is yours.

- Names. The node is called `velocity_limiter`; it has these topics and parameters:

| topic          | type                      |                                    |
|----------------|---------------------------|------------------------------------|
| `/cmd_vel_in`  | `geometry_msgs/msg/Twist` | what somebody wants; you subscribe |
| `/cmd_vel`     | `geometry_msgs/msg/Twist` | the same with `linear.x` limited   |
| `/wheel_speed` | `std_msgs/msg/Float64`    | rad/s                              |
| `/status`      | `std_msgs/msg/String`     | a line, twice a second             |

| parameter        | type   | default         | valid                  |                        |
|------------------|--------|-----------------|------------------------|------------------------|
| `robot_name`     | string | `default_robot` | not empty              | begins the status line |
| `max_velocity`   | double | 1.0             | 0.0 < v <= 5.0, finite | m/s, limits `linear.x` |
| `wheel_diameter` | double | 0.1             | 0.01 .. 1.0            | m, for `/wheel_speed`  |
| `enabled`        | bool   | true            |                        | false: all is zero     |

- The limit: `linear.x` lies between -`max_velocity` and +`max_velocity` when you publish it. The sign stays, and so
  do all other fields. `/wheel_speed` is the published `linear.x` / (`wheel_diameter` / 2). With `enabled` false,
  `/cmd_vel` is all zero, and so is `/wheel_speed`.
- A command brings exactly one message on `/cmd_vel` and one on `/wheel_speed`, and none later. That holds with
  `enabled` false, too. Both come within 3 s, in any order.
- The status line is made of `robot_name` and `max_velocity`: `default_robot: 1.0 m/s`. The number is not rounded:
  1.23456789 shows all its digits. Otherwise it may be written in any way, `1`, `1.0` or `1e0`. On average a line
  comes every 0.42 to 0.6 s.
- Topics connect to reliable, volatile endpoints, the default. A queue may have any depth: a command is sent only
  after the one before was answered.
- A change acts on every command that is sent 0.2 s or more after your node confirmed the change, and within 1 s on
  the status line. Whoever changes a parameter has an answer within 1 s. Everything else goes on meanwhile.
- An invalid value is refused, and the old value stays. The reason names the parameter and states, as a number, the
  end of its range that the value breaks: `max_velocity must be above 0.0 and at most 5.0`. rclpy's own message about
  a range is enough; for `robot_name`, naming the parameter is enough.
- The ends of the ranges: `max_velocity` 0.0 is refused, and so are NaN and infinity for both numbers. No test outside
  the ranges comes closer to them than 0.0001. `max_velocity` 5.0 is valid, and so are `wheel_diameter` 0.01 and 1.0.
- A value of another type is refused, even an integer for a double, and so is an undeclared parameter. No reason is
  needed there.
- Together or not at all: when a valid and an invalid value are set atomically, nothing changes.
- Values given at the start count, on the command line (`--ros-args -p max_velocity:=2.5`) or in a parameter file.
- An invalid value at the start never takes effect, and the program's output names the parameter. Either the node
  stops with an error: the program ends, and a traceback is enough output. Or the default replaces the value, with a
  warning: your logger's `warning()`, or any output that names the parameter.
- If your answer only defines the class, the grader calls `VelocityLimiter()`, without arguments, and spins it on a
  `MultiThreadedExecutor` with four threads or more. If there are several node classes, it takes the one with this
  name.
- If your answer makes a node itself, in a `main()` that it calls or at its top level, the grader runs it as a
  program. It has to spin its node and keep running. Let `rclpy.init()` see the command-line arguments. How it is
  built inside is otherwise up to you.
- The node has to be there within 5 s of each of its starts, after at most 2 s of computing.
- More nodes, topics, services, actions and parameters are allowed.
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

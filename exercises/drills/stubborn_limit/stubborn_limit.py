"""Drill 4: the parameter that changes nothing.

`ros2 param set /speed_limiter max_speed 0.5` says "successful", and the robot drives as fast as before.

The program runs. Repair what is wrong with it:

- Topics. The program, which its own `main` starts, subscribes to `/speed_in` and publishes `/speed`, both
  `std_msgs/msg/Float64`.
- The parameter. Its node is called `speed_limiter` and has the parameter `max_speed`, a double, which is 1.0 at the
  start.
- The limit. Each message on `/speed_in` brings one on `/speed`: the same value, or `max_speed` if that is less.
- A change. A change of `max_speed` acts on the next message.
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class SpeedLimiter(Node):
    def __init__(self):
        super().__init__("speed_limiter")
        self.declare_parameter("max_speed", 1.0)
        self.max_speed = self.get_parameter("max_speed").value
        self.speed = self.create_publisher(Float64, "speed", 10)
        self.create_subscription(Float64, "speed_in", self.limit, 10)

    def limit(self, message):
        self.speed.publish(Float64(data=min(message.data, self.max_speed)))


def main():
    rclpy.init()
    try:
        rclpy.spin(SpeedLimiter())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()

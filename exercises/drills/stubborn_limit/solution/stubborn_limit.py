"""Drill 4, repaired."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class SpeedLimiter(Node):
    def __init__(self):
        super().__init__("speed_limiter")
        self.declare_parameter("max_speed", 1.0)
        self.speed = self.create_publisher(Float64, "speed", 10)
        self.create_subscription(Float64, "speed_in", self.limit, 10)

    def limit(self, message):
        max_speed = self.get_parameter("max_speed").value
        self.speed.publish(Float64(data=min(message.data, max_speed)))


def main():
    rclpy.init()
    try:
        rclpy.spin(SpeedLimiter())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()

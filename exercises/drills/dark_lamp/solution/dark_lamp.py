"""Drill 6, repaired."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, Float64


class Lamp(Node):
    def __init__(self):
        super().__init__("lamp")
        self.lamp = self.create_publisher(Bool, "lamp", 10)
        self.create_subscription(Float64, "brightness", self.switch, 10)

    def switch(self, message):
        self.lamp.publish(Bool(data=message.data > 0.5))


def main():
    rclpy.init()
    try:
        rclpy.spin(Lamp())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()

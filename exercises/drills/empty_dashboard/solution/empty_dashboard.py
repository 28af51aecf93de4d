"""Drill 1, repaired."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64, Int32


class BatteryMonitor(Node):
    def __init__(self):
        super().__init__("battery_monitor")
        self.voltage = self.create_publisher(Float64, "voltage", 10)
        self.create_subscription(Int32, "millivolts", self.convert, 10)

    def convert(self, message):
        self.voltage.publish(Float64(data=message.data / 1000))


def main():
    rclpy.init()
    try:
        rclpy.spin(BatteryMonitor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()

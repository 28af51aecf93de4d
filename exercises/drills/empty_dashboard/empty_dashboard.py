"""Drill 1: the dashboard stays empty.

`ros2 topic echo /voltage` shows each voltage. The dashboard subscribes to the same topic and never gets one.

The program runs. Repair what is wrong with it:

- Topics. The program, which its own `main` starts, subscribes to `/millivolts` (`std_msgs/msg/Int32`) and publishes
  `/voltage` (`std_msgs/msg/Float64`). It connects to every node that has a queue of 10 at its end and sets nothing
  else, as the dashboard does.
- Volts. Each message on `/millivolts` brings one on `/voltage`, with the value in volts: divided by 1000.
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Float64, Int32


class BatteryMonitor(Node):
    def __init__(self):
        super().__init__("battery_monitor")
        self.voltage = self.create_publisher(Float64, "voltage", qos_profile_sensor_data)
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

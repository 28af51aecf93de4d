"""Drill 6: the lamp stays dark.

The slider publishes on `/brightness`, the lamp subscribes to `/brightness`. Nothing happens, and no error
appears anywhere.

The program runs. Repair what is wrong with it:

- Topics. The program, which its own `main` starts, listens to the slider, which publishes `std_msgs/msg/Float64` on
  `/brightness`, and publishes `/lamp` (`std_msgs/msg/Bool`).
- The lamp. Each brightness brings one message on `/lamp`, which says whether it is above 0.5.
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, Float32


class Lamp(Node):
    def __init__(self):
        super().__init__("lamp")
        self.lamp = self.create_publisher(Bool, "lamp", 10)
        self.create_subscription(Float32, "brightness", self.switch, 10)

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

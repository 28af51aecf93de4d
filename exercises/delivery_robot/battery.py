"""The capstone, first program: the battery.

The names and types are right already; keep them. The rest is yours.

- Full at the start. Then `percentage` is 1.0. It is never more, also at the dock.
- It falls with each message on `/odometry_distance` by the metres driven since the previous message / `capacity_m`,
  and not below 0.0. The first message only says where the counting begins. A smaller number than the one before comes
  from a carrier that was started again: nothing was driven. A change of `capacity_m` counts for what is driven
  afterwards.
- It rises while `/docked` says true: by about 0.1 a second (0.05 to 0.2). `power_supply_status` is then CHARGING; it
  is DISCHARGING after `/docked` has said false.
- It is low when `percentage` is below `low_fraction`: then `power_supply_health` is DEAD, else GOOD.
- All of this and each change of a parameter shows in the messages within 1 s.
- The rate is `publish_hz`: on average the messages come after the right period, give or take a quarter.
- An invalid value of the three parameters, such as NaN, is refused. The reason names the parameter. rclpy's own
  message about a range is enough.
"""

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool, Float64


class Battery(Node):
    """Publishes /battery."""

    def __init__(self):
        super().__init__("battery")
        # Declare the three parameters here. How will an invalid value be refused?
        self.state = self.create_publisher(BatteryState, "battery", 10)
        self.create_subscription(Float64, "odometry_distance", self.drive, 10)
        self.create_subscription(Bool, "docked", self.dock, 10)
        # Who publishes, and how often?

    def drive(self, message):
        """The robot has driven message.data metres in all."""
        # Your code goes here.

    def dock(self, message):
        """Whether the robot stands at the dock."""
        # Your code goes here.


def main():
    rclpy.init()
    try:
        rclpy.spin(Battery())
    except KeyboardInterrupt:
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

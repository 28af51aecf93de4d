"""The capstone, solved: the battery, which falls with the metres driven and rises at the dock."""

import math
import time

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool, Float64

CHARGED_IN_A_SECOND = 0.1
SLOWEST, FASTEST = 1.0, 50.0  # messages a second
RANGES = {  # what each parameter may be, in words and as a condition
    "capacity_m": ("above 0.0, and finite", lambda value: 0.0 < value < math.inf),
    "publish_hz": ("1.0 to 50.0", lambda value: SLOWEST <= value <= FASTEST),
    "low_fraction": ("0.0 to 1.0", lambda value: 0.0 <= value <= 1.0),
}


class Battery(Node):
    """Publishes /battery."""

    def __init__(self) -> None:
        super().__init__("battery")
        self.charge = 1.0  # full at the start
        self.metres: float | None = None  # as /odometry_distance said last
        self.docked = False
        self.counted = time.monotonic()  # until when the charging is counted
        self.add_on_set_parameters_callback(self.judge)  # first, so that it judges what is given at the start
        self.declare_parameter("capacity_m", 100.0)
        self.declare_parameter("publish_hz", 5.0)
        self.declare_parameter("low_fraction", 0.2)
        self.state = self.create_publisher(BatteryState, "battery", 10)
        self.create_subscription(Float64, "odometry_distance", self.drive, 10)
        self.create_subscription(Bool, "docked", self.dock, 10)
        self.timer = self.create_timer(1.0 / self.get_parameter("publish_hz").value, self.publish)
        self.add_post_set_parameters_callback(self.keep_rate)

    def judge(self, parameters: list[Parameter]) -> SetParametersResult:
        """Refuse a value outside its range."""
        for one in parameters:
            words, is_valid = RANGES.get(one.name, ("", lambda _: True))
            if not is_valid(one.value):
                return SetParametersResult(successful=False, reason=f"{one.name} must be {words}, not {one.value}")
        return SetParametersResult(successful=True)

    def keep_rate(self, parameters: list[Parameter]) -> None:
        """Publish at the rate that was set."""
        for one in parameters:
            if one.name == "publish_hz":
                self.timer.timer_period_ns = int(1e9 / one.value)

    def drive(self, message: Float64) -> None:
        """The robot has driven since the last message; a smaller number comes from a carrier that began anew."""
        driven = message.data - (message.data if self.metres is None else self.metres)
        self.metres = message.data
        self.charge = max(self.charge - max(driven, 0.0) / self.get_parameter("capacity_m").value, 0.0)

    def dock(self, message: Bool) -> None:
        """The robot charges from now on, or no longer."""
        self.count()
        self.docked = message.data

    def count(self) -> None:
        """Count what was charged since the last time."""
        now = time.monotonic()
        if self.docked:
            self.charge = min(self.charge + CHARGED_IN_A_SECOND * (now - self.counted), 1.0)
        self.counted = now

    def publish(self) -> None:
        """Tell how full it is."""
        self.count()
        low = self.charge < self.get_parameter("low_fraction").value
        state = BatteryState(percentage=self.charge, present=True)
        state.header.stamp = self.get_clock().now().to_msg()
        state.power_supply_health = BatteryState.POWER_SUPPLY_HEALTH_DEAD if low else state.POWER_SUPPLY_HEALTH_GOOD
        state.power_supply_status = state.POWER_SUPPLY_STATUS_DISCHARGING
        if self.docked:
            state.power_supply_status = state.POWER_SUPPLY_STATUS_CHARGING
        self.state.publish(state)


def main() -> None:
    """Run the node until Ctrl-C."""
    rclpy.init()
    try:
        rclpy.spin(Battery())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

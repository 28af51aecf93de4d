"""The capstone, third program: the carrier.

The names and types are right already; keep them. The rest is yours.

- Rooms. The robot starts at the dock, and stays where it is when a goal ends. A goal names a room, or `dock`, which
  lies at 0.0 m.
- First the door. Each delivery calls `/door/open` with `data` true, and drives only when the answer says `success`.
  More calls are allowed, also to close the door.
- Then the drive. The robot drives with `speed_mps`: a drive takes at least its distance / `speed_mps`, and at most
  twice that plus 1 s.
- There, the goal ends SUCCEEDED with `delivered` true, and `distance` is what the robot drove for it, within 0.05 m.
  The next goal starts from there.
- Feedback: at least one message with the `phase` `door` before the door answers; while the robot drives at least five
  a second with `driving`. `distance_remaining` begins with the whole distance, never grows, and is at most 0.1 m in
  the last message. `battery` is the last `percentage` on `/battery`.
- When a goal has ended, `/odometry_distance` and `/docked` are right within 0.5 s.
- No. A room that is not in `room_names` is rejected. While `/battery` says DEAD every goal but `dock` is rejected;
  this holds from 0.5 s after the message. While a goal runs, others are rejected; if two come at the same instant,
  only one is accepted. The one that runs is not disturbed.
- The door says no: the goal ends ABORTED within 1 s, with `delivered` false, and the robot has not moved. The
  `message` contains the door's.
- The door says nothing: without an answer for `door_timeout_s` the goal ends ABORTED, not before and at most 2 s
  later; the `message` is not empty. After that the next delivery works.
- Cancel. At any moment a request to cancel is accepted within 1 s, and the goal ends CANCELED within 1 s more, with
  `delivered` false. The robot stops there; `distance` is what it drove, and the next goal starts from there.
- Changed parameters count from the next goal on.
"""

import rclpy
from course_interfaces.action import Deliver
from rclpy.action import ActionServer
from rclpy.node import Node
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool, Float64
from std_srvs.srv import SetBool


class Carrier(Node):
    """Offers /deliver."""

    def __init__(self):
        super().__init__("carrier")
        # Declare the four parameters here.
        self.odometry = self.create_publisher(Float64, "odometry_distance", 10)
        self.docked = self.create_publisher(Bool, "docked", 10)
        self.create_subscription(BatteryState, "battery", self.keep_battery, 10)
        self.door = self.create_client(SetBool, "door/open")
        # Which goals are accepted? Who may cancel one? Who publishes the two topics?
        self.server = ActionServer(self, Deliver, "deliver", execute_callback=self.execute)

    def keep_battery(self, state):
        """What the battery says."""
        # Your code goes here.

    def execute(self, goal_handle):
        """Bring the parcel to the room goal_handle.request.room: first the door, then the way."""
        # Your code goes here. Every way out says how the goal ended.
        goal_handle.abort()
        return Deliver.Result(message="this robot has not learned to drive yet")


def main():
    rclpy.init()
    try:
        rclpy.spin(Carrier())
    except KeyboardInterrupt:
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

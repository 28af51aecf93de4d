"""The capstone, solved: the carrier, which asks the door and drives, one delivery at a time."""

import threading
import time

import rclpy
from course_interfaces.action import Deliver
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Bool, Float64
from std_srvs.srv import SetBool

DOCK = "dock"
STEP_S = 0.05


class Carrier(Node):
    """Offers /deliver."""

    def __init__(self) -> None:
        super().__init__("carrier")
        self.declare_parameter("room_names", ["kitchen"])
        self.declare_parameter("room_distances_m", [2.0])
        self.declare_parameter("speed_mps", 0.5)
        self.declare_parameter("door_timeout_s", 3.0)
        self.position = 0.0  # metres from the dock
        self.driven = 0.0  # metres since the start
        self.battery = BatteryState()
        self.busy = threading.Lock()  # held while a goal has the robot; two threads cannot both get it
        self.odometry = self.create_publisher(Float64, "odometry_distance", 10)
        self.docked = self.create_publisher(Bool, "docked", 10)
        self.create_subscription(BatteryState, "battery", self.keep_battery, 10)
        self.create_timer(0.1, self.tell_where)
        self.door = self.create_client(SetBool, "door/open")
        self.server = ActionServer(
            self,
            Deliver,
            "deliver",
            execute_callback=self.execute,
            goal_callback=self.decide_on_goal,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def keep_battery(self, state: BatteryState) -> None:
        """Keep what the battery says."""
        self.battery = state

    def tell_where(self) -> None:
        """Publish how far the robot has driven, and whether it stands at the dock."""
        self.odometry.publish(Float64(data=self.driven))
        self.docked.publish(Bool(data=self.position == 0.0))

    def rooms(self) -> dict[str, float]:
        """The metres from the dock, by the names of the rooms."""
        names, distances = (self.get_parameter(name).value for name in ("room_names", "room_distances_m"))
        return {**dict(zip(names, distances, strict=False)), DOCK: 0.0}

    def decide_on_goal(self, goal: Deliver.Goal) -> GoalResponse:
        """Accept a room that is there, with enough charge or on the way to the dock, one goal at a time."""
        low = self.battery.power_supply_health == BatteryState.POWER_SUPPLY_HEALTH_DEAD
        if goal.room not in self.rooms() or (low and goal.room != DOCK):
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT if self.busy.acquire(blocking=False) else GoalResponse.REJECT

    def execute(self, goal_handle: ServerGoalHandle) -> Deliver.Result:
        """Deliver, and be free for the next goal, whatever has happened."""
        before = self.driven
        try:
            problem = self.deliver(goal_handle, self.rooms()[goal_handle.request.room])
        finally:
            self.busy.release()
        result = Deliver.Result(delivered=not problem, distance=self.driven - before, message=problem)
        if not problem:
            goal_handle.succeed()
        elif goal_handle.is_cancel_requested:
            goal_handle.canceled()
        else:
            goal_handle.abort()
        return result

    def deliver(self, goal_handle: ServerGoalHandle, target: float) -> str:
        """Have the door opened, then drive; what went wrong, in words."""
        return self.open_door(goal_handle, target) or self.drive(goal_handle, target)

    def open_door(self, goal_handle: ServerGoalHandle, target: float) -> str:
        """Ask for the door, and wait on this thread: others take the answer in, and a request to cancel."""
        answered, answer = threading.Event(), self.door.call_async(SetBool.Request(data=True))
        answer.add_done_callback(lambda _: answered.set())
        end = time.monotonic() + self.get_parameter("door_timeout_s").value
        self.tell(goal_handle, Deliver.Feedback.DOOR, target)
        while not answered.wait(STEP_S):
            if goal_handle.is_cancel_requested:
                return "cancelled at the door"
            if time.monotonic() > end:
                self.door.remove_pending_request(answer)
                return "the door did not answer"
        return "" if answer.result().success else f"the door did not open: {answer.result().message}"

    def drive(self, goal_handle: ServerGoalHandle, target: float) -> str:
        """Drive to the target, as far as the time that has passed allows."""
        speed, before = self.get_parameter("speed_mps").value, time.monotonic()
        while self.position != target:
            self.tell(goal_handle, Deliver.Feedback.DRIVING, target)
            time.sleep(STEP_S)
            if goal_handle.is_cancel_requested:
                return "cancelled on the way"
            now = time.monotonic()
            step = min(speed * (now - before), abs(target - self.position))
            before = now
            self.position = target if step == abs(target - self.position) else self.position + self.side(target) * step
            self.driven += step
        self.tell(goal_handle, Deliver.Feedback.DRIVING, target)
        return ""

    def side(self, target: float) -> float:
        """The sign of the way to the target."""
        return 1.0 if target > self.position else -1.0

    def tell(self, goal_handle: ServerGoalHandle, phase: str, target: float) -> None:
        """Send feedback."""
        left = abs(target - self.position)
        goal_handle.publish_feedback(
            Deliver.Feedback(phase=phase, distance_remaining=left, battery=self.battery.percentage)
        )


def main() -> None:
    """Run the node until Ctrl-C: one thread delivers, others answer."""
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Carrier())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        executor.shutdown()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

"""What `ros2 action send_goal` makes sure of before it sends."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .commands import Ros2

# The result is how many questions the server had answered when the goal came.
PROGRAM = """
import rclpy
from rclpy.action import ActionServer
from example_interfaces.action import Fibonacci

class Counting(ActionServer):
    asked = 0

    async def _execute_get_result_request(self, request):
        self.asked += 1
        await super()._execute_get_result_request(request)

def count(goal):
    answered = server.asked
    goal.publish_feedback(Fibonacci.Feedback(sequence=[goal.request.order]))
    goal.succeed()
    return Fibonacci.Result(sequence=[answered])

rclpy.init()
node = rclpy.create_node("counting")
server = Counting(node, Fibonacci, "count", count)
rclpy.spin(node)
"""
GOAL = ("action", "send_goal", "/count", "example_interfaces/action/Fibonacci", "{order: 7}")


def test_feedback_is_asked_for_only_when_the_server_knows_its_reader(ros2: Ros2) -> None:
    program = ros2.folder / "counting.py"
    program.write_text(PROGRAM)
    ros2.start(program, "/counting")
    shown = ros2(*GOAL, "--feedback").stdout
    assert "Feedback:\n    sequence:\n- 7\n" in shown
    assert "Result:\n    sequence:\n- 1\n" in shown
    assert "Feedback:" not in ros2(*GOAL).stdout

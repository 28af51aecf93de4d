"""Exercise 2: an action server that drives a robot to a point.

The names and the type are right already; keep them. All the rest is yours: how to drive, what to tell on the way, which
goals to accept, and how to stop when a client wants that.

- Names. The node is called `move_robot_server`. It offers the action `/move_robot`, whose type is
  `course_interfaces/action/MoveRobot`.
- Drive there. A goal in the arena is accepted and ends SUCCEEDED when the robot is within 5 cm of the target. The
  arena goes from 0 to 10 m in x and in y, and its edges belong to it. In the result, `final_position` says where the
  robot is. `distance_travelled` is the length of this move alone, to within 5 cm or 5 %, whichever is more. Whatever
  stands in `z`, even NaN, is ignored: distances and `progress` are those in x and y.
- Already there? A goal at the present position succeeds within 1 s. It needs no feedback.
- Drive straight. The robot goes straight to the target, moved by `step_towards` alone: no position lies 0.1 m or more
  beside the way. The position that you report, in feedback and result, is `robot.position`. You may write your own
  motion loop in place of `SimulatedRobot`.
- Tell how it goes. A move of 1 m or more brings at least five feedback messages per metre: nine for 1.8 m, the first
  and the last included. They are spread over the move: one comes in each third of the way. At least 40 % of the
  move's time passes between the first message and the last. `progress` goes from 0 to 1 and is 1 -
  `distance_remaining` / the length of this goal's way, within 0.05. On such a move the first message comes before a
  tenth of the way is done. The last one comes when at most 5 cm remain, before the goal ends. A message before the
  first step is allowed. `progress` never falls, and `distance_remaining` never grows. `distance_remaining` is the
  straight way from the `position` in the same message to the target, within 0.1 m.
- Say no. A target outside the arena is rejected, even by only 1 mm. So is a target whose x or y is NaN or infinite.
  So is a goal that arrives while another one runs, from its acceptance until its result. A rejected goal changes
  nothing: the first goal goes on undisturbed, and the next valid one is accepted. Of two goals sent at the same
  instant, one is accepted and the other rejected.
- Stop when asked. A request to cancel is accepted within 1 s, at any moment until 0.3 m before the target. The goal
  ends CANCELED within 1 s more; `final_position` says where the robot has stopped, short of the target, and
  `distance_travelled` what it drove. If the robot reaches its target at that very moment, the goal may end SUCCEEDED.
  The robot drives no further; the next goal works, and starts from there.
- Be quick. A move may take 3 s per metre, plus 2 s. All times here are seconds on the clock, also in the grader,
  although its robot drives sixteen times as fast.
- If your answer only defines the class, the grader calls `MoveRobotServer()`, without arguments, and spins it on a
  `MultiThreadedExecutor` with four threads or more. If there are several node classes, it takes the one with this
  name.
- If your answer makes a node itself, in a `main()` that it calls or at its top level, the grader runs it as a
  program. It has to spin its node and keep running. On one thread, your node hears no request to cancel while a loop
  in `execute` drives. How it is built inside is otherwise up to you.
- The action has to be there within 5 s of the start, after at most 2 s of computing.
- More nodes, topics, services, actions and parameters are allowed.
"""

import rclpy
from course_interfaces.action import MoveRobot
from rclpy.action import ActionServer
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

from course_kit.robot import SimulatedRobot


class MoveRobotServer(Node):
    """Offers /move_robot."""

    def __init__(self):
        super().__init__("move_robot_server")
        self.robot = SimulatedRobot()
        self.server = ActionServer(self, MoveRobot, "move_robot", execute_callback=self.execute)

    def execute(self, goal_handle):
        """Drive to the target of one goal.

        goal_handle.request.target        where to; x and y in metres
        self.robot.position               where the robot is: (x, y) in metres
        self.robot.step_towards(x, y)     drives 5 cm and takes 0.05 s

        goal_handle.publish_feedback(...) tells the client, with a MoveRobot.Feedback: position, the straight way
                                          left (x and y), progress from 0 to 1
        goal_handle.is_cancel_requested   True once a request to cancel was accepted; the ActionServer's
                                          cancel_callback decides that, and without one it is refused
        goal_handle.succeed(), .abort() or .canceled() say how the goal ended

        Returns a MoveRobot.Result, filled in.
        """
        # Your code goes here.
        return MoveRobot.Result()


def main():
    rclpy.init()
    node = MoveRobotServer()
    try:
        # Several threads: one is busy in execute, another one hears a request to cancel.
        rclpy.spin(node, executor=MultiThreadedExecutor(num_threads=4))
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

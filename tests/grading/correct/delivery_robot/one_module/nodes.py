"""A node and how one is run; the programs start one each."""

import time

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool


class Door(Node):
    """Offers /door/open."""

    def __init__(self) -> None:
        super().__init__("door")
        self.declare_parameter("locked", False)
        self.declare_parameter("opening_s", 0.5)
        # Reentrant: while one request waits for the door, another thread takes the next.
        self.create_service(SetBool, "door/open", self.move, callback_group=ReentrantCallbackGroup())

    def move(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Open or close the door."""
        if request.data and self.get_parameter("locked").value:
            response.message = "the door is locked"
            return response
        if request.data:
            time.sleep(self.get_parameter("opening_s").value)
        response.success = True
        response.message = "open" if request.data else "closed"
        return response


def run(node_class: type[Node]) -> None:
    """Run one of them."""
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=6)
    executor.add_node(node_class())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()

"""One thread: the callback of the service awaits a timer."""

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import SetBool


class SlowDoor(Node):
    def __init__(self) -> None:
        super().__init__("door")
        self.declare_parameter("locked", False)
        self.declare_parameter("opening_s", 0.5)
        self.group = ReentrantCallbackGroup()
        self.service = self.create_service(SetBool, "/door/open", self.answer, callback_group=self.group)

    async def answer(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        if request.data and self.get_parameter("locked").value:
            response.success, response.message = False, "locked"
            return response
        if request.data:
            opened = Future(executor=self.executor)
            timer = self.create_timer(
                self.get_parameter("opening_s").value, lambda: opened.set_result(True), callback_group=self.group
            )
            await opened
            self.destroy_timer(timer)
        response.success = True
        return response


def main() -> None:
    rclpy.init()
    try:
        rclpy.spin(SlowDoor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

"""All three nodes in one process, on one executor."""

import rclpy
from battery import Battery
from carrier import Carrier
from door import Door
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor


def main() -> None:
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=10)
    for node_class in (Battery, Door, Carrier):
        executor.add_node(node_class())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

"""Three spinning threads, three nodes of other names, the answer from a worker pool through a future."""

import math
import threading
from concurrent.futures import ThreadPoolExecutor

import rclpy
from course_interfaces.srv import ConvertTemperature
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

POOL = ThreadPoolExecutor(3)
UNITS = [ConvertTemperature.Request.CELSIUS, ConvertTemperature.Request.FAHRENHEIT]


def work(value, units):
    if any(unit not in UNITS for unit in units):
        return "unit?"
    offset, factor = (32.0, 1.8) if units[0] == UNITS[1] else (0.0, 1.0)
    if not math.isfinite(value) or (value - offset) / factor < -273.15:
        return "value?"
    if units[0] == units[1]:
        return value
    return (value - 32.0) / 1.8 if units[0] == UNITS[1] else value * 1.8 + 32.0


class Idle(Node):
    pass


class TemperatureService(Node):
    def __init__(self):
        super().__init__("temperature_service")
        group = ReentrantCallbackGroup()
        self.create_service(ConvertTemperature, "convert_temperature", self.ask_worker, callback_group=group)

    def ask_worker(self, request, response):
        found = POOL.submit(work, request.value, (request.from_unit, request.to_unit)).result()
        if isinstance(found, str):
            response.success, response.message = False, found
        else:
            response.success, response.value = True, found
        return response


if __name__ == "__main__":
    rclpy.init()
    threads = []
    for node in (Idle("first"), TemperatureService(), Idle("last")):
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        threads.append(threading.Thread(target=executor.spin))
        threads[-1].start()
    for thread in threads:
        thread.join()

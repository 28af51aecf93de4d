"""A match statement on the whole question; its own context, executor and signal handler; top level."""

import math
import signal
import sys

from course_interfaces.srv import ConvertTemperature
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

LARGEST = sys.float_info.max


def solve(value, units):
    match units:
        case ["celsius", _] if not -273.15 <= value <= LARGEST:
            return None
        case ["fahrenheit", _] if not -459.67 <= value <= LARGEST:
            return None
        case ["celsius", "celsius"] | ["fahrenheit", "fahrenheit"]:
            return value
        case ["celsius", "fahrenheit"]:
            return 32 + 9 * value / 5 if value < 1e300 else math.inf
        case ["fahrenheit", "celsius"]:
            return 5 / 9 * (value - 32)
    return None


def answer(request, response):
    found = solve(request.value, [request.from_unit, request.to_unit])
    response.success = found is not None
    response.message = "" if response.success else "?"
    response.value = 0.0 if found is None else found
    return response


context = Context()
context.init()
signal.signal(signal.SIGTERM, lambda *_: context.try_shutdown())
node = Node("temperature_service", context=context, start_parameter_services=False, enable_rosout=False)
node.create_service(ConvertTemperature, "convert_temperature", answer)
executor = SingleThreadedExecutor(context=context)
executor.add_node(node)
while context.ok():
    executor.spin_once(timeout_sec=0.1)

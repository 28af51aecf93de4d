"""Two nodes, each with an executor and a thread of its own."""

import math
import threading

import rclpy
from course_interfaces.srv import ConvertTemperature
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


def fill(request, response):
    scale = {"celsius": (1.0, 0.0), "fahrenheit": (1.8, 32.0)}
    if request.from_unit not in scale or request.to_unit not in scale:
        response.message = "unbekannte Einheit"
        return response
    factor, offset = scale[request.from_unit]
    celsius = (request.value - offset) / factor
    if not math.isfinite(celsius) or celsius < -273.15:
        response.message = "keine Temperatur"
        return response
    factor, offset = scale[request.to_unit]
    same = request.from_unit == request.to_unit
    response.value = request.value if same else celsius * factor + offset
    response.success = True
    return response


class Heartbeat(Node):
    def __init__(self):
        super().__init__("heartbeat")
        self.create_timer(0.05, lambda: None)


class TemperatureService(Node):
    def __init__(self):
        super().__init__("temperature_service")
        self.create_service(ConvertTemperature, "convert_temperature", fill)


def main():
    rclpy.init()
    executors = [SingleThreadedExecutor(), SingleThreadedExecutor()]
    for executor, node in zip(executors, (TemperatureService(), Heartbeat()), strict=True):
        executor.add_node(node)
    threads = [threading.Thread(target=executor.spin) for executor in executors]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


if __name__ == "__main__":
    main()

"""A reentrant group on several threads, with another service asked from the callback."""

import math

import rclpy
from course_interfaces.srv import ConvertTemperature
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger


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


class TemperatureService(Node):
    def __init__(self):
        super().__init__("temperature_service")
        group = ReentrantCallbackGroup()
        self.create_service(Trigger, "is_calibrated", self.is_calibrated, callback_group=group)
        self.client = self.create_client(Trigger, "is_calibrated", callback_group=group)
        self.create_service(ConvertTemperature, "convert_temperature", self.convert, callback_group=group)
        self.calibrated = False

    def is_calibrated(self, request, response):
        response.success = request is not None
        return response

    def convert(self, request, response):
        if not self.calibrated:
            self.calibrated = self.client.call(Trigger.Request()).success
        return fill(request, response)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=12)
    executor.add_node(TemperatureService())
    executor.spin()


if __name__ == "__main__":
    main()

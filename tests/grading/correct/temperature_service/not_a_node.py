"""The named class is no Node: it has one."""

import math

import rclpy
from course_interfaces.srv import ConvertTemperature


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


class TemperatureService:
    def __init__(self):
        self.node = rclpy.create_node("temperature_service")
        self.service = self.node.create_service(ConvertTemperature, "convert_temperature", self.answer)
        self.answered = 0

    def answer(self, request, response):
        self.answered += 1
        self.node.get_logger().info(f"request {self.answered}: {request.value} {request.from_unit}")
        return fill(request, response)

    def run(self):
        while rclpy.ok():
            rclpy.spin_once(self.node, timeout_sec=0.1)


def main():
    rclpy.init()
    TemperatureService().run()


if __name__ == "__main__":
    main()

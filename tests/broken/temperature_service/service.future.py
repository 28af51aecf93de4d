# service.future: waits for a Future whose result nobody sets
import math

import rclpy
from course_interfaces.srv import ConvertTemperature
from rclpy.node import Node
from rclpy.task import Future

UNITS = ("celsius", "fahrenheit")


class TemperatureService(Node):
    def __init__(self):
        super().__init__("temperature_service")
        self.service = self.create_service(ConvertTemperature, "convert_temperature", self.convert)

    async def convert(self, request, response):
        calibrated = Future()
        self.get_logger().info("calibrating first")
        await calibrated
        return self.answer(request, response)

    def answer(self, request, response):
        if request.from_unit not in UNITS or request.to_unit not in UNITS:
            response.success = False
            response.message = "unknown unit"
            return response
        limit = -273.15 if request.from_unit == "celsius" else -459.67
        if not math.isfinite(request.value) or request.value < limit:
            response.success = False
            response.message = "not a temperature"
            return response
        if request.from_unit == request.to_unit:
            response.value = request.value
        elif request.to_unit == "fahrenheit":
            response.value = request.value * 9.0 / 5.0 + 32.0
        else:
            response.value = (request.value - 32.0) * 5.0 / 9.0
        response.success = True
        return response


def main():
    rclpy.init()
    rclpy.spin(TemperatureService())


if __name__ == "__main__":
    main()

"""Every conversion goes through Kelvin, which costs digits but none that the exercise asks for."""

import math

from course_interfaces.srv import ConvertTemperature
from rclpy.node import Node

TO_KELVIN = {"celsius": lambda value: value + 273.15, "fahrenheit": lambda value: (value + 459.67) * 5 / 9}
FROM_KELVIN = {"celsius": lambda value: value - 273.15, "fahrenheit": lambda value: value * 9 / 5 - 459.67}


class TemperatureService(Node):
    def __init__(self):
        super().__init__("temperature_service")
        self.create_service(ConvertTemperature, "convert_temperature", self.convert)

    def convert(self, request, response):
        try:
            kelvin = TO_KELVIN[request.from_unit](request.value)
            value = FROM_KELVIN[request.to_unit](kelvin)
        except KeyError as unknown:
            response.message = f"no such unit: {unknown}"
            return response
        if not math.isfinite(kelvin) or kelvin < 0.0:
            response.message = "there is no such temperature"
            return response
        response.success = True
        response.value = request.value if request.from_unit == request.to_unit else value
        return response

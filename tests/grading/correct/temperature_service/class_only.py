"""Only the class: somebody else spins it."""

import math

from course_interfaces.srv import ConvertTemperature
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
    response.success, response.message = True, "umgerechnet"
    return response


class TemperatureService(Node):
    def __init__(self):
        super().__init__("temperature_service")
        self.create_service(ConvertTemperature, "convert_temperature", fill)

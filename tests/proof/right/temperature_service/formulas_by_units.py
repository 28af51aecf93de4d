"""Formulas in a dictionary, a decorator that refuses, and a composition: the node is no class."""

import functools
import math

import rclpy
from course_interfaces.srv import ConvertTemperature

C, F = "celsius", "fahrenheit"
FORMULAS = {(C, C): float, (F, F): float, (C, F): lambda x: x * 1.8 + 32, (F, C): lambda x: (x - 32) / 1.8}
LOWEST = {C: -273.15, F: -459.67}


class RefusedError(Exception):
    pass


def answers(function):
    @functools.wraps(function)
    def wrapper(request, response):
        try:
            response.value, response.success = function(request), True
        except RefusedError as reason:
            response.success, response.message = False, str(reason)
        return response

    return wrapper


@answers
def convert(request):
    try:
        formula = FORMULAS[request.from_unit, request.to_unit]
    except KeyError as units:
        raise RefusedError(f"keine solche Einheit: {units}") from None
    if not LOWEST[request.from_unit] <= request.value < math.inf:
        raise RefusedError("keine Temperatur")
    return formula(request.value)


class TemperatureService:
    def __init__(self):
        self.node = rclpy.create_node("temperature_service")
        self.node.create_service(ConvertTemperature, "convert_temperature", convert)


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(TemperatureService().node)

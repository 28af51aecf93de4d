"""asyncio beside rclpy, an Enum for the units, a lifecycle node."""

import asyncio
import enum
import math

import rclpy
from course_interfaces.srv import ConvertTemperature
from rclpy.lifecycle import LifecycleNode


class Unit(enum.Enum):
    CELSIUS = "celsius"
    FAHRENHEIT = "fahrenheit"

    def to_kelvin(self, value):
        return value + 273.15 if self is Unit.CELSIUS else (value + 459.67) * (5 / 9)

    def from_kelvin(self, kelvin):
        return kelvin - 273.15 if self is Unit.CELSIUS else kelvin * 9 / 5 - 459.67


class TemperatureService(LifecycleNode):
    def __init__(self):
        super().__init__("temperature_service")
        self.create_service(ConvertTemperature, "convert_temperature", self.on_request)

    def on_request(self, request, response):
        try:
            start, end = Unit(request.from_unit), Unit(request.to_unit)
            kelvin = start.to_kelvin(request.value)
            if not -1e-9 < kelvin < math.inf:
                raise ValueError(f"{kelvin} K is no temperature")
        except ValueError as problem:
            response.message = str(problem)
            return response
        response.success = True
        response.value = request.value if start is end else end.from_kelvin(kelvin)
        return response


async def spin(node):
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0)
        await asyncio.sleep(0.002)


if __name__ == "__main__":
    rclpy.init()
    asyncio.run(spin(TemperatureService()))

# ros.newer: rclpy.init() as a context manager, which newer versions have
"""Exercise 1, solved: a service that converts temperatures between Celsius and Fahrenheit."""

import math

import rclpy
from course_interfaces.srv import ConvertTemperature
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

CELSIUS = ConvertTemperature.Request.CELSIUS
FAHRENHEIT = ConvertTemperature.Request.FAHRENHEIT
ABSOLUTE_ZERO = -273.15  # degrees Celsius


def to_celsius(value: float, unit: str) -> float:
    """The temperature in degrees Celsius."""
    return value if unit == CELSIUS else (value - 32.0) * 5.0 / 9.0


def from_celsius(celsius: float, unit: str) -> float:
    """The temperature in `unit`."""
    return celsius if unit == CELSIUS else celsius * 9.0 / 5.0 + 32.0


def problem_with(request: ConvertTemperature.Request) -> str:
    """Why a request cannot be answered; empty when it can."""
    for unit in (request.from_unit, request.to_unit):
        if unit not in (CELSIUS, FAHRENHEIT):
            return f"unknown unit '{unit}': use '{CELSIUS}' or '{FAHRENHEIT}'"
    if not math.isfinite(request.value):
        return f"{request.value} is not a temperature"
    if to_celsius(request.value, request.from_unit) < ABSOLUTE_ZERO:
        return f"{request.value} {request.from_unit} is below absolute zero ({ABSOLUTE_ZERO} {CELSIUS})"
    return ""


class TemperatureService(Node):
    """Offers /convert_temperature."""

    def __init__(self) -> None:
        super().__init__("temperature_service")
        self.service = self.create_service(ConvertTemperature, "convert_temperature", self.convert)

    def convert(
        self, request: ConvertTemperature.Request, response: ConvertTemperature.Response
    ) -> ConvertTemperature.Response:
        """Answer one request; a refusal carries its reason."""
        response.message = problem_with(request)
        response.success = not response.message
        if not response.success:
            return response
        if request.from_unit == request.to_unit:
            response.value = request.value  # through Celsius and back the last digit would suffer
        else:
            response.value = from_celsius(to_celsius(request.value, request.from_unit), request.to_unit)
        return response


def main() -> None:
    """Run the node until Ctrl-C."""
    with rclpy.init():
        run(TemperatureService())


def run(node: TemperatureService) -> None:
    """Run a node until Ctrl-C."""
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

"""Exercise 1: a service that converts temperatures between Celsius and Fahrenheit.

Fill in `convert`. The node's name, the service's name and its type are right already; keep them.
"""

import rclpy
from course_interfaces.srv import ConvertTemperature
from rclpy.node import Node


class TemperatureService(Node):
    """Offers /convert_temperature."""

    def __init__(self):
        super().__init__("temperature_service")
        self.service = self.create_service(ConvertTemperature, "convert_temperature", self.convert)

    def convert(self, request, response):
        """Answer one request.

        request.value      the temperature, a float
        request.from_unit  "celsius" or "fahrenheit" ...
        request.to_unit    ... or something else: then refuse, and say why

        response.success   True if there is a result
        response.value     the result, a float
        response.message   when refused: the reason
        """
        # Your code goes here.
        return response


def main():
    rclpy.init()
    node = TemperatureService()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

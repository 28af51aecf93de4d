"""Exercise 1: a service that converts temperatures between Celsius and Fahrenheit.

Fill in `convert`. The node's name, the service's name and its type are right already; keep them.

- Both directions: success is True and value holds the result. message may then hold anything.
- A unit to itself: the value comes back bit for bit.
- Every digit counts: within 1e-12 of the exact value, relative or absolute, for values up to 1e9. No rounding.
- Refuse an unknown unit, NaN, infinity, and anything colder than absolute zero: success is False, and message says why,
  in any language: "no such unit: kelvin". Refuse them when both units are the same, too. The node lives on.
- Units are the exact words: "Celsius", "C", " celsius" and "" are unknown.
- Absolute zero itself, -273.15 C, is valid. It is -459.67 F; there no test comes closer than 0.01 degrees.
- One call is answered within 1.5 s; fifty calls, at most ten unanswered at a time, within 5 s, each with its own value.

More nodes, services, topics and parameters are allowed. The grader runs this file as a program: how it is built inside
is up to you. Without a `main` that is called, it makes TemperatureService(), without arguments, and spins it on a
MultiThreadedExecutor with four threads or more. The service has to be there within 5 s of the start, after at most 2 s
of computing.
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

"""Exercise 1: a service that converts temperatures between Celsius and Fahrenheit.

Fill in `convert`. The names and the type are right already; keep them.

- Names. The node is called `temperature_service`. It offers the service `/convert_temperature`, whose type is
  `course_interfaces/srv/ConvertTemperature`.
- Both directions. Celsius becomes Fahrenheit and Fahrenheit becomes Celsius: `value` holds the result. With a result,
  `success` is `True`. `message` may then hold anything.
- A unit to itself. The value comes back bit for bit. Do not convert it to the other unit and back: that changes the
  last digit.
- Every digit counts. Do not round: the result is within 1e-12 of the exact value, relative or absolute, for values up
  to 1e9. Every usual formula is that exact.
- Say no when the question makes no sense. `success` is `False` for an unknown unit, for NaN and infinity, and for
  anything colder than absolute zero. Then `message` says why: `no such unit: kelvin`. Any human language will do.
  Check first: a question that makes no sense is refused even when both units are the same, such as NaN from celsius
  to celsius. The node lives on for the next request.
- Units are the exact words `celsius` and `fahrenheit`. `Celsius`, `C`, a word with a space before or after it and the
  empty string are unknown units.
- Absolute zero itself is valid: -273.15 degrees Celsius. In Fahrenheit it is -459.67; no test comes closer to it than
  0.01 degrees, because of rounding.
- Be quick. One call is answered within 1.5 s. Fifty calls, at most ten of them waiting for an answer at a time, are
  answered within 5 s, each with its own value.
- If your answer only defines the class, the grader calls `TemperatureService()`, without arguments, and spins it on a
  `MultiThreadedExecutor` with four threads or more. If there are several node classes, it takes the one with this
  name.
- If your answer makes a node itself, in a `main()` that it calls or at its top level, the grader runs it as a
  program. It has to spin its node and keep running. How it is built inside is up to you.
- The service has to be there within 5 s of the start, after at most 2 s of computing.
- More nodes, services, topics, actions and parameters are allowed.
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

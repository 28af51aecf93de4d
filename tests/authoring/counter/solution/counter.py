import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from std_srvs.srv import Trigger


class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.number = 0
        self.declare_parameter("step", 1)
        self.add_on_set_parameters_callback(self.judge)
        self.create_service(Trigger, "count", self.count)
        self.create_service(Trigger, "reset_count", self.reset)

    def judge(self, parameters):
        for one in parameters:
            if one.name == "step" and not 1 <= one.value <= 10:
                return SetParametersResult(successful=False, reason="step must be from 1 to 10")
        return SetParametersResult(successful=True)

    def count(self, request, response):
        new = self.number + self.get_parameter("step").value
        if new > 30:
            response.message = "the counter is full"
        else:
            self.number = new
            response.success, response.message = True, str(new)
        return response

    def reset(self, request, response):
        if self.number == 0:
            response.message = "there is nothing to reset"
        else:
            self.number = 0
            response.success = True
        return response


def main():
    rclpy.init()
    rclpy.spin(Counter())


if __name__ == "__main__":
    main()

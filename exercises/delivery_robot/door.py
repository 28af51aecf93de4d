"""The capstone, second program: the door.

The names and types are right already; keep them. The rest is yours.

- Open. `data` true opens the door: the answer, `success` true, comes after `opening_s`, not before, and at most 1 s
  later.
- Close. `data` false closes it: the answer, `success` true, comes within 1 s, also while the door is locked.
- Locked. While `locked` is true, a request to open is refused within 1 s: `success` false. The `message` then says
  why. When `locked` is false again, the next request opens the door.
- Not blocked. While the door opens, the node answers everything else at once: requests (also to open), and questions
  about its parameters. A request that came before the door was locked still opens it.
"""

import rclpy
from rclpy.node import Node
from std_srvs.srv import SetBool


class Door(Node):
    """Offers /door/open."""

    def __init__(self):
        super().__init__("door")
        # Declare the two parameters here.
        self.create_service(SetBool, "door/open", self.move)

    def move(self, request, response):
        """Open the door if request.data is true, else close it."""
        # Your code goes here. Who answers the others while the door opens?
        response.message = "this door is only painted on the wall"
        return response


def main():
    rclpy.init()
    try:
        rclpy.spin(Door())
    except KeyboardInterrupt:
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()

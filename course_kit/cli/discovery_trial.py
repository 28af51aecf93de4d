"""How long two processes take to find each other and speak, tried out."""

from __future__ import annotations

import sys
import time

from course_kit import environment
from course_kit.process.child import NOWHERE, Child

DEADLINE_S = 20.0

# A service server in a process of its own: what the doctor's client has to discover.
_SERVER = """
import rclpy
from std_srvs.srv import Trigger
rclpy.init()
node = rclpy.create_node("doctor_server")
def answer(request, response):
    response.success = True
    return response
node.create_service(Trigger, "doctor", answer)
try:
    rclpy.spin(node)
except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
    pass
"""


def seconds() -> float | None:
    """Seconds until a client was answered by a server in another process, on a domain of their own; None if never."""
    with environment.exclusive_domain() as domain_id:
        environ = environment.child_environment(ROS_DOMAIN_ID=str(domain_id))
        server = Child([sys.executable, "-c", _SERVER], environ=environ, folder="/", stderr=NOWHERE)
        try:
            return _ask(domain_id)
        finally:
            server.kill()  # a signal that rclpy handles now and then leaves it hanging at its end


def _ask(domain_id: int) -> float | None:
    """Seconds until the server answered, start of its Python included; None when it never did."""
    import rclpy
    from rclpy.context import Context
    from rclpy.executors import SingleThreadedExecutor
    from std_srvs.srv import Trigger

    from course_kit.ros.graph import quiet_node
    from course_kit.ros.service import ServiceClient

    started = time.monotonic()
    context = Context()
    rclpy.init(context=context, domain_id=domain_id)
    try:
        node = quiet_node("doctor_client", context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        client = ServiceClient(node, Trigger, "doctor")
        sent = None
        while time.monotonic() - started < DEADLINE_S:
            if sent is None and client.is_ready():
                sent = client.send(Trigger.Request())
            executor.spin_once(timeout_sec=0.02)  # returns as soon as there is anything to do
            if sent is not None and sent.answered():
                return time.monotonic() - started
        return None
    finally:
        context.try_shutdown()

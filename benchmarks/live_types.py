"""Live types against compiled ones: `python benchmarks/live_types.py`.

The same service, SetBool, once with the class compiled into the wheels (std_srvs) and once with the one made from
text at run time (example_interfaces has the same fields). One process, one executor thread, taking turns.
"""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import rclpy
from example_interfaces.srv import SetBool as LiveSetBool
from measure import interleaved, print_table
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from std_srvs.srv import SetBool as CompiledSetBool

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Callable

CALLS, ROUNDS = 20, 60


def answer(request: Any, response: Any) -> Any:
    """A callback that does next to nothing."""
    response.success = request.data
    response.message = "as you wish"
    return response


def caller(node: Any, service_type: Any, name: str) -> Callable[[], None]:
    """A function that makes `CALLS` round trips on a service of its own."""
    node.create_service(service_type, name, answer)
    client = node.create_client(service_type, name)

    def calls() -> None:
        for _ in range(CALLS):
            done = threading.Event()
            future = client.call_async(service_type.Request(data=True))
            future.add_done_callback(lambda _, done=done: done.set())
            assert done.wait(10)  # noqa: S101

    return calls


def main() -> None:
    with environment.exclusive_domain() as domain_id:
        context = Context()
        rclpy.init(context=context, domain_id=domain_id)
        node = rclpy.create_node("benchmark", context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        thread = threading.Thread(target=executor.spin)
        thread.start()
        try:
            sides = {
                "compiled": caller(node, CompiledSetBool, "compiled"),
                "live": caller(node, LiveSetBool, "live"),
            }
            print_table(f"{CALLS} service round trips in one process", interleaved(sides, ROUNDS), {"live": 1.1})
        finally:
            executor.shutdown()
            thread.join()
            context.try_shutdown()


if __name__ == "__main__":
    main()

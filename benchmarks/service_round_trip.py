"""Service calls against bare rclpy: `python benchmarks/service_round_trip.py`.

A server node and a client node are on one background thread. Bare rclpy has a SingleThreadedExecutor, and a future that
sets an event, or wakes an event loop. The lab is used from a program (`call_blocking`) and from asyncio (`await call`),
and each is compared with bare rclpy used in the same way: to wake an event loop of another thread costs more than to
set an event, whoever does it. Then bare rclpy with the same service, SetBool, once with the class compiled into the
wheels (std_srvs) and once with the one made from text at run time (example_interfaces has the same fields).
"""

from __future__ import annotations

import asyncio
import threading
from typing import TYPE_CHECKING, Any

import rclpy
from example_interfaces.srv import SetBool as LiveSetBool
from measure import interleaved, print_table
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

from course_kit import environment, lab

if TYPE_CHECKING:
    from collections.abc import Callable

CALLS, ROUNDS = 20, 60
LAB_AIM, LIVE_AIM = 1.05, 1.1


class Server(Node):
    """Answers at once."""

    def __init__(self, name: str, service_type: Any = SetBool, **options: Any) -> None:
        super().__init__(name, **options)
        self.create_service(service_type, name, self.answer)

    def answer(self, request: Any, response: Any) -> Any:
        """Agree."""
        response.success = request.data
        response.message = "as you wish"
        return response


class Bare:
    """Servers and clients on one executor thread, as in a program that spins in the background."""

    def __init__(self, domain_id: int) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=domain_id)
        self.asker = Node("asker", context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.asker)
        self.clients = {}
        for name, service_type in (("compiled", SetBool), ("live", LiveSetBool)):
            self.executor.add_node(Server(name, service_type, context=self.context))
            self.clients[service_type] = self.asker.create_client(service_type, name)
        self.thread = threading.Thread(target=self.executor.spin)
        self.thread.start()

    def calls(self, service_type: Any = SetBool) -> None:
        """Make `CALLS` round trips."""
        for _ in range(CALLS):
            done = threading.Event()
            future = self.clients[service_type].call_async(service_type.Request(data=True))
            future.add_done_callback(lambda _, done=done: done.set())
            assert done.wait(10)  # noqa: S101

    async def awaited_calls(self) -> None:
        """The same from asyncio."""
        loop = asyncio.get_running_loop()
        for _ in range(CALLS):
            answered = loop.create_future()
            future = self.clients[SetBool].call_async(SetBool.Request(data=True))
            future.add_done_callback(lambda _, answered=answered: loop.call_soon_threadsafe(answered.set_result, None))
            await asyncio.wait_for(answered, 10)

    def close(self) -> None:
        """End the thread, then the context."""
        self.executor.shutdown()
        self.thread.join()
        self.context.try_shutdown()


def blocking_calls() -> None:
    """The same through the lab, from a program."""
    for _ in range(CALLS):
        lab.call_blocking("/lab", SetBool, data=True)


async def awaited_calls() -> None:
    """The same through the lab, from a notebook's event loop."""
    for _ in range(CALLS):
        await lab.call("/lab", SetBool, data=True)


def compare(title: str, aim: float, sides: dict[str, Callable[[], object]]) -> None:
    """Print a table; the aim is for each side but the first."""
    title = f"{CALLS} service round trips in one process, {title}"
    print_table(title, interleaved(sides, ROUNDS), dict.fromkeys(list(sides)[1:], aim))


def main() -> None:
    with environment.exclusive_domain() as domain_id:
        bare = Bare(domain_id)
        lab.start(Server, "lab")
        loop = asyncio.new_event_loop()
        compare("from a program", LAB_AIM, {"bare rclpy": bare.calls, "lab.call_blocking": blocking_calls})
        from_asyncio = {
            "bare rclpy": lambda: loop.run_until_complete(bare.awaited_calls()),
            "await lab.call": lambda: loop.run_until_complete(awaited_calls()),
        }
        compare("from asyncio", LAB_AIM, from_asyncio)
        compare("of two types", LIVE_AIM, {"compiled": bare.calls, "live": lambda: bare.calls(LiveSetBool)})
        loop.close()
        lab.stop()
        bare.close()


if __name__ == "__main__":
    main()

"""A service call through the lab against bare rclpy: `python benchmarks/service_round_trip.py`.

The same work on both sides: a server node and a client node on one background thread. Bare rclpy has a
SingleThreadedExecutor, and a future that sets an event, or wakes an event loop. The lab is used from a program
(`call_blocking`) and from asyncio (`await call`), and each is compared with bare rclpy used in the same way: to wake an
event loop of another thread costs more than to set an event, whoever does it.
"""

from __future__ import annotations

import asyncio
import threading
from typing import Any

import rclpy
from measure import interleaved, print_table
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

from course_kit import environment, lab

CALLS, ROUNDS = 20, 60


class Server(Node):
    """Answers at once."""

    def __init__(self, name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self.create_service(SetBool, name, self.answer)

    def answer(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        """Agree."""
        response.success = request.data
        return response


class Bare:
    """A server and a client node on one executor thread, as in a program that spins in the background."""

    def __init__(self, domain_id: int) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=domain_id)
        self.server = Server("bare", context=self.context)
        self.asker = Node("asker", context=self.context)
        self.client = self.asker.create_client(SetBool, "bare")
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.server)
        self.executor.add_node(self.asker)
        self.thread = threading.Thread(target=self.executor.spin)
        self.thread.start()

    def calls(self) -> None:
        """Make `CALLS` round trips."""
        for _ in range(CALLS):
            done = threading.Event()
            future = self.client.call_async(SetBool.Request(data=True))
            future.add_done_callback(lambda _, done=done: done.set())
            assert done.wait(10)  # noqa: S101

    async def awaited_calls(self) -> None:
        """The same from asyncio."""
        loop = asyncio.get_running_loop()
        for _ in range(CALLS):
            answered = loop.create_future()
            future = self.client.call_async(SetBool.Request(data=True))
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


def main() -> None:
    with environment.exclusive_domain() as domain_id:
        bare = Bare(domain_id)
        lab.start(Server, "lab")
        loop = asyncio.new_event_loop()
        from_a_program = {"bare rclpy": bare.calls, "lab.call_blocking": blocking_calls}
        from_asyncio = {
            "bare rclpy": lambda: loop.run_until_complete(bare.awaited_calls()),
            "await lab.call": lambda: loop.run_until_complete(awaited_calls()),
        }
        for way, sides in (("from a program", from_a_program), ("from asyncio", from_asyncio)):
            title = f"{CALLS} service round trips in one process, {way}"
            print_table(title, interleaved(sides, ROUNDS), dict.fromkeys(list(sides)[1:], 1.05))
        loop.close()
        lab.stop()
        bare.close()


if __name__ == "__main__":
    main()

"""The recorder on real action servers and clients, of the lab and of scripts."""

from __future__ import annotations

import asyncio
import re
from typing import Any

import pytest
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node

from course_kit import lab
from tests.lab.action_nodes import Fibonaccis, Stubborn, Waiting


def drawn() -> list[str]:
    return re.sub(r"\n {5,}", " ", str(lab.diagram())).splitlines()


@pytest.mark.usefixtures("recording")
def test_a_goal_of_the_lab() -> None:
    lab.start(Fibonaccis)
    lab.send_goal_blocking("/fibonacci", Fibonacci, order=7).result_blocking()
    lab.send_goal_blocking("/fibonacci", Fibonacci, order=-1)
    assert drawn() == [
        "1. lab -> fibonaccis  /fibonacci goal: order=7",
        "2. fibonaccis -> lab  /fibonacci goal response: accepted",
        "3. fibonaccis -> lab  /fibonacci feedback: sequence=[0, 1, 1]",
        "4. fibonaccis -> lab  /fibonacci feedback: ... 4 more",
        "5. fibonaccis -> lab  /fibonacci feedback: sequence=[0, 1, 1, 2, 3, 5, 8, 13]",
        "6. fibonaccis -> lab  /fibonacci result: SUCCEEDED, sequence=[0, 1, 1, 2, 3, 5, 8, 13]",
        "7. lab -> fibonaccis  /fibonacci goal: order=-1",
        "8. fibonaccis -> lab  /fibonacci goal response: rejected",
    ]


@pytest.mark.usefixtures("recording")
def test_cancelling() -> None:
    lab.start(Waiting)
    stubborn = lab.start(Stubborn)

    async def follow() -> None:
        goal = await lab.send_goal("/fibonacci", Fibonacci, order=5)
        async for _ in goal:
            break
        await goal.cancel()
        await goal.result()
        goal = await lab.send_goal("/stubborn", Fibonacci, order=5)
        await goal.cancel()
        stubborn.release.set()
        await goal.result()

    asyncio.run(follow())
    assert drawn() == [
        " 1. lab -> waiting  /fibonacci goal: order=5",
        " 2. waiting -> lab  /fibonacci goal response: accepted",
        " 3. waiting -> lab  /fibonacci feedback: sequence=[0, 1, 1]",
        " 4. lab -> waiting  /fibonacci cancel request",
        " 5. waiting -> lab  /fibonacci cancel response: accepted",
        " 6. waiting -> lab  /fibonacci result: CANCELED, sequence=[0, 1, 1]",
        " 7. lab -> stubborn  /stubborn goal: order=5",
        " 8. stubborn -> lab  /stubborn goal response: accepted",
        " 9. lab -> stubborn  /stubborn cancel request",
        "10. stubborn -> lab  /stubborn cancel response: refused",
        "11. stubborn -> lab  /stubborn result: SUCCEEDED, sequence=[7]",
    ]


@pytest.mark.usefixtures("recording")
def test_a_learners_own_client() -> None:
    class Asking(Node):
        def __init__(self) -> None:
            super().__init__("asking")
            self.client = ActionClient(self, Fibonacci, "fibonacci")

    async def ask(node: Any) -> None:
        handle = await node.client.send_goal_async(Fibonacci.Goal(order=2))
        await handle.get_result_async()

    lab.start(Fibonaccis)
    node = lab.start(Asking)
    assert node.client.wait_for_server(10)
    asyncio.run(ask(node))
    assert [line.split("  ")[0] for line in drawn()] == [
        "1. asking -> fibonaccis",
        "2. fibonaccis -> asking",
        "3. fibonaccis -> asking",
        "4. fibonaccis -> asking",
    ]

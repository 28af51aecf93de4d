"""Who offers and uses what on the graph."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.context import Context
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

from course_kit.ros import graph
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator


@pytest.fixture
def busy(domain: int) -> Iterator[Node]:
    context = Context()
    rclpy.init(context=context, domain_id=domain)
    node = Node("busy", namespace="/left", context=context)
    node.create_service(SetBool, "power", lambda _, response: response)
    node.create_client(Trigger, "/reset")
    node.create_publisher(String, "/words", 10)
    server = ActionServer(node, Fibonacci, "fibonacci", lambda _: Fibonacci.Result())
    wait_until(lambda: "/left/fibonacci" in graph.offered_types(node, graph.RUNS))
    yield node
    server.destroy()
    node.destroy_node()
    context.try_shutdown()


def test_what_a_node_does(busy: Node) -> None:
    own = {(use.role, use.channel, use.types) for use in graph.read_graph(busy).uses_of("/left/busy")}
    assert own == {
        (graph.SERVES, "/left/power", ("std_srvs/srv/SetBool",)),
        (graph.CALLS, "/reset", ("std_srvs/srv/Trigger",)),
        (graph.RUNS, "/left/fibonacci", ("example_interfaces/action/Fibonacci",)),
        (graph.PUBLISHES, "/words", ("std_msgs/msg/String",)),
    }
    assert graph.node_names(busy) == ["/left/busy"]


def test_what_is_offered_and_by_whom(busy: Node) -> None:
    assert graph.offered_types(busy, graph.SERVES)["/left/power"] == ["std_srvs/srv/SetBool"]
    assert "/reset" not in graph.offered_types(busy, graph.SERVES)  # it has a client and no server
    assert graph.offered_types(busy, graph.RUNS) == {"/left/fibonacci": ["example_interfaces/action/Fibonacci"]}
    assert graph.offered_types(busy, graph.RUNS, frozenset({"/left/busy"})) == {}

"""Subscriptions that connect with whoever publishes already."""

from __future__ import annotations

import itertools
import time
from typing import TYPE_CHECKING

import pytest
import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from course_kit.ros.graph import quiet_node
from course_kit.ros.topic import as_offered
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator

PATIENCE = 60.0
OFFERED = list(
    itertools.product(
        (ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT),
        (DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL),
    )
)


@pytest.fixture
def context(domain: int) -> Iterator[Context]:
    made = Context()
    rclpy.init(context=made, domain_id=domain)
    yield made
    made.try_shutdown()


@pytest.mark.parametrize(("reliability", "durability"), OFFERED)
@pytest.mark.parametrize("latched", [False, True])
def test_whatever_is_offered_arrives(
    context: Context, reliability: ReliabilityPolicy, durability: DurabilityPolicy, latched: bool
) -> None:
    node, heard = quiet_node("_both", context), []
    publisher = node.create_publisher(
        String, "/words", QoSProfile(depth=5, reliability=reliability, durability=durability)
    )
    wait_until(lambda: node.count_publishers("/words") == 1)
    publisher.publish(String(data="early"))
    chosen = as_offered(keepers=node.get_publishers_info_by_topic("/words") if latched else [])
    node.create_subscription(String, "/words", lambda message: heard.append(message.data), chosen)
    wait_until(lambda: publisher.get_subscription_count() == 1)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    deadline = time.monotonic() + PATIENCE
    while "late" not in heard and time.monotonic() < deadline:
        publisher.publish(String(data="late"))
        executor.spin_once(timeout_sec=0.1)
    kept = latched and durability == DurabilityPolicy.TRANSIENT_LOCAL and reliability == ReliabilityPolicy.RELIABLE
    assert heard[0] == ("early" if kept else "late")
    executor.shutdown()


def test_who_listens_first_hears_the_default_publisher_that_comes_later(context: Context) -> None:
    node = quiet_node("_both", context)
    node.create_subscription(
        String, "/words", lambda _: None, as_offered(keepers=node.get_publishers_info_by_topic("/words"))
    )
    publisher = node.create_publisher(String, "/words", 10)
    wait_until(lambda: publisher.get_subscription_count() == 1)

"""What comes on a topic, and who is at its other end."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import pytest
from std_msgs.msg import Int32

from course_kit.ros.topic import Inbox, MessageInfo
from tests.ros.two_nodes import TwoNodes

if TYPE_CHECKING:
    from collections.abc import Iterator


class Pair(TwoNodes):
    def __init__(self, domain_id: int) -> None:
        super().__init__(domain_id, ("talker", "listener"))
        self.talker, self.listener = self.nodes


@pytest.fixture
def pair(domain: int) -> Iterator[Pair]:
    made = Pair(domain)
    yield made
    made.close()


def test_what_comes_is_kept_with_its_time(pair: Pair) -> None:
    inbox = Inbox()
    publisher = pair.talker.create_publisher(Int32, "/numbers", 10)
    subscription = inbox.subscribe(pair.listener, Int32, "numbers", 10)
    pair.spin_until(lambda: subscription.get_publisher_count() == 1 and publisher.get_subscription_count() == 1)
    before = time.time()
    for number in range(3):
        publisher.publish(Int32(data=number))
    pair.spin_until(lambda: inbox.count == 3)
    assert [message.data for message in inbox.messages] == [0, 1, 2]
    assert before <= inbox.times[0] <= inbox.times[2] <= time.time()


def test_of_many_messages_the_last_are_kept_and_all_are_counted() -> None:
    inbox = Inbox(kept=2)
    for number in range(5):
        inbox.take(number, MessageInfo(source_timestamp=0, received_timestamp=number * 1_000_000_000))
    assert (inbox.count, list(inbox.messages), list(inbox.times)) == (5, [3, 4], [3.0, 4.0])
    assert (inbox.newer_than(4), inbox.newer_than(0), inbox.newer_than(5)) == ([4], [3, 4], [])

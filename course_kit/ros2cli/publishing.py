"""Publishing on a topic, for `topic pub`."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from course_kit.ros.messages import type_name
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli import qos
from course_kit.ros2cli.errors import CommandError
from course_kit.ros2cli.values import TypedValues, find_type, typed

if TYPE_CHECKING:
    from argparse import Namespace

    from rclpy.publisher import Publisher

    from course_kit.ros2cli.session import Session

_REPORT_EVERY = 1.0  # seconds between two lines while it waits


def publish(options: Namespace, session: Session, topic: str) -> None:
    """Publish as `topic pub` does."""
    if options.rate <= 0:
        raise CommandError(f"--rate has to be a number above 0, not {options.rate:g}.")
    times = 1 if options.once else options.times
    wanted = (1 if times else 0) if options.wait_matching_subscriptions is None else options.wait_matching_subscriptions
    if not wanted and options.max_wait is not None:
        raise CommandError("--max-wait-time-secs needs --wait-matching-subscriptions, --once or --times.")
    message_type = find_type(options.message_type, "msg")
    values = TypedValues(typed(options, "values"), type_name(message_type))
    message = message_type()
    values.put_into(message)
    if options.node_name:
        session.call_node(options.node_name)
    publisher = session.node.create_publisher(message_type, topic, qos.for_publishing(options))
    _wait_for_subscriptions(publisher, topic, wanted, options, session)
    print("publisher: beginning loop", flush=True)
    count = 0
    while True:
        count += 1
        if count > 1 and values.are_of_the_moment:
            values.put_into(message)
        if options.print_every and count % options.print_every == 0:
            print(f"publishing #{count}: {message!r}\n", flush=True)
        publisher.publish(message)
        if count == times:
            break
        time.sleep(1.0 / options.rate)
    _wait_for_delivery(publisher, options.timeout)


def _wait_for_subscriptions(
    publisher: Publisher, topic: str, wanted: int, options: Namespace, session: Session
) -> None:
    timeout = options.timeout if options.max_wait is None else options.max_wait
    deadline = time.monotonic() + timeout
    while publisher.get_subscription_count() < wanted:
        print(f"Waiting for at least {wanted} matching subscription(s)...", flush=True)
        left = deadline - time.monotonic()
        if session.wait_on_graph(lambda: publisher.get_subscription_count() >= wanted, min(left, _REPORT_EVERY)):
            return
        if time.monotonic() >= deadline:
            topics = {name for name, _ in session.node.get_topic_names_and_types()} - {topic}
            found = publisher.get_subscription_count()
            raise CommandError(
                f"{f'Only {found}' if found else 'Nobody'} subscribed to {topic} within {timeout:g} s "
                f"(waiting for {wanted}).{did_you_mean(topic, topics)}"
            )


def _wait_for_delivery(publisher: Publisher, timeout: float) -> None:
    """A node that leaves at once takes its last message with it; a reliable reader confirms it."""
    from rclpy.duration import Duration

    publisher.wait_for_all_acked(Duration(nanoseconds=int(min(timeout, 1e9) * 1e9)))

"""Listening to a topic and publishing on it, for `topic echo`, `hz` and `pub`."""

from __future__ import annotations

import math
import statistics
import time
from collections import deque
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from course_kit.ros.messages import type_name
from course_kit.ros.names import did_you_mean
from course_kit.ros.topic import Inbox
from course_kit.ros2cli import types
from course_kit.ros2cli.errors import CommandError

if TYPE_CHECKING:
    from argparse import Namespace

    from rclpy.node import Node
    from rclpy.publisher import Publisher

    from course_kit.ros.messages import Message
    from course_kit.ros2cli.session import Session
    from course_kit.ros2cli.text import Layout

_REPORT_EVERY = 1.0  # seconds between two lines of `topic hz`, and of `topic pub` while it waits


class Listener:
    """A subscription that hands messages on until there are none.

    Args:
        options: parsed: `timeout` and the quality of service; `message_type`, `once`, `field` and `csv` of `echo`.
        session: the command's.
        topic: its full name.
    """

    def __init__(self, options: Namespace, session: Session, topic: str) -> None:
        self._options, self._session, self._topic = options, session, topic
        self._inbox = Inbox()

    def echo(self, layout: Layout) -> None:
        """Print messages as YAML or CSV, for as long as they come."""
        from course_kit.ros2cli.text import to_csv, to_yaml

        self._subscribe()
        while True:
            _, message = self._next()
            shown = self._field(message)
            if self._options.csv:
                print(to_csv(shown, layout), flush=True)
            else:
                print(f"{to_yaml(shown, layout)}---", flush=True)
            if self._options.once:
                return

    def rate(self, window: int) -> None:
        """Print once a second how often messages have come, over the last `window` of them.

        Raises:
            CommandError: the window is too small.
        """
        if window < 2:  # noqa: PLR2004 - a rate needs two
            raise CommandError(f"--window has to be a number of messages, at least 2, not {window}.")
        self._subscribe()
        times: deque[float] = deque(maxlen=window)
        report_at = time.monotonic() + _REPORT_EVERY
        while True:
            times.append(self._next()[0])
            if time.monotonic() >= report_at and len(times) > 1:
                _print_rate(list(times))
                report_at = time.monotonic() + _REPORT_EVERY

    def _subscribe(self) -> None:
        from course_kit.ros2cli import qos

        node = self._session.node
        type_name = getattr(self._options, "message_type", None) or self._type_on_graph(node)
        message_type = types.find_type(type_name, "msg")
        profile = qos.for_listening(self._options, node.get_publishers_info_by_topic(self._topic))
        self._inbox.subscribe(node, message_type, self._topic, profile)

    def _next(self) -> tuple[float, Message]:
        if not self._session.spin_until(lambda: bool(self._inbox.messages), self._options.timeout):
            publishers = self._session.node.count_publishers(self._topic)
            raise CommandError(
                f"No message on {self._topic} for {self._options.timeout:g} s; "
                f"{publishers or 'no'} publisher{'' if publishers == 1 else 's'} on it. "
                "A longer wait: --timeout SECONDS."
            )
        return self._inbox.times.popleft(), self._inbox.messages.popleft()

    def _type_on_graph(self, node: Node) -> str:
        found: dict[str, list[str]] = {}

        def is_there() -> bool:
            found.update(node.get_topic_names_and_types())
            return self._topic in found

        if not self._session.wait_on_graph(is_there, self._options.timeout):
            raise CommandError(
                f"Could not determine the type of {self._topic}: it has not appeared within "
                f"{self._options.timeout:g} s.{did_you_mean(self._topic, found)}"
            )
        if len(found[self._topic]) > 1:
            raise CommandError(
                f"{self._topic} has the types {', '.join(found[self._topic])} at once: name the one to listen to."
            )
        return found[self._topic][0]

    def _field(self, message: Message) -> Any:
        for name in (self._options.field or "").split(".") if self._options.field else ():
            if not hasattr(message, "get_fields_and_field_types") or name not in message.get_fields_and_field_types():
                known: dict[str, str] = getattr(message, "get_fields_and_field_types", dict)()
                raise CommandError(f"There is no field {name!r} in the message.{did_you_mean(name, known)}")
            message = getattr(message, name)
        return message


def _print_rate(times: list[float]) -> None:
    gaps = [later - earlier for earlier, later in pairwise(times)]
    mean = statistics.fmean(gaps)
    print(
        f"average rate: {1.0 / mean if mean else math.inf:.3f}\n"
        f"\tmin: {min(gaps):.3f}s max: {max(gaps):.3f}s std dev: {statistics.pstdev(gaps):.5f}s window: {len(times)}",
        flush=True,
    )


def publish(options: Namespace, session: Session, topic: str) -> None:
    """Publish as `topic pub` does.

    Args:
        options: parsed.
        session: the command's.
        topic: its full name.

    Raises:
        CommandError: the values do not fit, or nobody subscribes in time.
    """
    from course_kit.ros2cli import qos, values

    if options.rate <= 0:
        raise CommandError(f"--rate has to be a number above 0, not {options.rate:g}.")
    node = session.node
    message_type = types.find_type(options.message_type, "msg")
    message = message_type()
    values.fill(message, options.values, type_name(message_type))
    times = 1 if options.once else options.times
    publisher = node.create_publisher(message_type, topic, qos.for_publishing(options))
    wanted = options.wait_matching_subscriptions
    _wait_for_subscriptions(publisher, topic, (1 if times else 0) if wanted is None else wanted, options, session)
    print("publisher: beginning loop", flush=True)
    count = 0
    while True:
        count += 1
        if count % max(options.print_every, 1) == 0:
            print(f"publishing #{count}: {message!r}\n", flush=True)
        publisher.publish(message)
        if count == times:
            break
        time.sleep(1.0 / options.rate)
    _wait_for_delivery(publisher, options.timeout)


def _wait_for_subscriptions(
    publisher: Publisher, topic: str, wanted: int, options: Namespace, session: Session
) -> None:
    deadline = time.monotonic() + options.timeout
    while publisher.get_subscription_count() < wanted:
        print(f"Waiting for at least {wanted} matching subscription(s)...", flush=True)
        left = deadline - time.monotonic()
        if session.wait_on_graph(lambda: publisher.get_subscription_count() >= wanted, min(left, _REPORT_EVERY)):
            return
        if time.monotonic() >= deadline:
            topics = {name for name, _ in session.node.get_topic_names_and_types()} - {topic}
            found = publisher.get_subscription_count()
            raise CommandError(
                f"{f'Only {found}' if found else 'Nobody'} subscribed to {topic} within {options.timeout:g} s "
                f"(waiting for {wanted}).{did_you_mean(topic, topics)}"
            )


def _wait_for_delivery(publisher: Publisher, timeout: float) -> None:
    """A node that leaves at once takes its last message with it; a reliable reader confirms it."""
    from rclpy.duration import Duration

    publisher.wait_for_all_acked(Duration(nanoseconds=int(min(timeout, 1e9) * 1e9)))

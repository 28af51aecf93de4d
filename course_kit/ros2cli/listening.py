"""Listening to a topic, for `topic echo`, `hz`, `bw` and `delay`, and publishing on one, for `topic pub`."""

from __future__ import annotations

import math
import sys
import time
from collections import deque
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from rclpy.qos import QoSPresetProfiles, QoSProfile

from course_kit.ros.messages import type_name
from course_kit.ros.names import did_you_mean
from course_kit.ros.topic import as_offered
from course_kit.ros2cli import values
from course_kit.ros2cli.session import CommandError, Session
from course_kit.ros2cli.text import layout_of, to_csv, to_yaml

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Iterator

    from rclpy.publisher import Publisher
    from rclpy.subscription import Subscription

    from course_kit.ros.messages import Message, MessageType

T = TypeVar("T")
REPORT_EVERY = 1.0  # seconds between two lines of figures, or of waiting
_WORD_AFTER = 10.0  # seconds without a message until the command says so
_SPIN_S = 0.5
_NS = 1e9


class ReceivedMessage(NamedTuple):
    """A message, bytes where it is not to be read, and when it came, in seconds of the system's clock."""

    at: float
    message: Any
    info: dict[str, int]  # what rclpy tells of it


class Listener:
    """A subscription that hands messages on."""

    def __init__(self, options: Namespace, session: Session, topic: str) -> None:
        self.options, self._session, self.topic = options, session, topic
        self._received: deque[ReceivedMessage] = deque()
        self._matches = _filter_of(getattr(options, "filter_expr", None))
        if (window := getattr(options, "window", 1)) < 1:
            raise CommandError(f"--window must be a number of messages, at least 1, not {window}.")

    def echo(self) -> None:
        """Print messages as YAML or CSV, for as long as they come."""
        options, layout = self.options, layout_of(self.options)
        self.subscribe(wait=False, raw=options.raw)
        while True:
            received = self.next_message()
            text = self._field(received.message)
            if not self._matches(text):
                continue
            if options.include_message_info:
                print(f"---Got new message, message info:---\n{received.info}\n---Message data:---", flush=True)
            if not hasattr(text, "get_fields_and_field_types"):
                print(f"{text}\n---", flush=True)
            elif options.csv:
                print(to_csv(text, layout), flush=True)
            else:
                print(f"{to_yaml(text, layout)}---", flush=True)
            if options.once:
                return

    def subscribe(self, *, wait: bool, raw: bool = False) -> None:
        """Subscribe."""
        node = self._session.node
        named = getattr(self.options, "message_type", None)
        message_type = values.find_type(named or self._type_on_graph(wait=wait), "msg")
        profile = _profile(self.options, as_offered(keepers=node.get_publishers_info_by_topic(self.topic)))
        self._subscribe(message_type, profile, raw=raw)

    def subscribe_to(self, message_type: MessageType, profile: str) -> Subscription:
        """Subscribe to messages of a known type with a profile of rclpy's, whether or not somebody publishes them."""
        qos = QoSPresetProfiles.get_from_short_key(profile)
        return self._subscribe(message_type, qos, raw=False)

    def _subscribe(self, message_type: MessageType, qos: QoSProfile, *, raw: bool) -> Subscription:
        def take(message: Any, info: dict[str, int]) -> None:
            self._received.append(ReceivedMessage(info["received_timestamp"] / _NS, message, info))

        node = self._session.node
        types = dict(node.get_topic_names_and_types()).get(node.resolve_topic_name(self.topic), [])
        if self._session.in_kernel and types and type_name(message_type) not in types:  # rcl does not say why
            raise CommandError(f"{self.topic} has the type {' and '.join(types)}, not {type_name(message_type)}.")
        callback: Callable[..., None] = take  # of two arguments, which rclpy allows and its types do not tell
        return node.create_subscription(message_type, self.topic, callback, qos, raw=raw)

    def next_message(self) -> ReceivedMessage:
        """The next message."""
        began = time.monotonic()
        timeout = math.inf if self.options.timeout is None else self.options.timeout
        has_warned = False
        while not self._session.spin_until(lambda: bool(self._received), min(_SPIN_S, timeout)):
            waited = time.monotonic() - began
            if waited >= timeout:
                raise CommandError(f"{self._silence(timeout)} A longer wait: --timeout SECONDS, or none for any time.")
            if waited >= _WORD_AFTER and not has_warned:
                has_warned = True
                sys.stderr.write(f"{self._silence(_WORD_AFTER)} Still listening; Ctrl-C ends it.\n")
        return self._received.popleft()

    def next_matching(self) -> ReceivedMessage:
        """The next message for which the filter holds."""
        while not self._matches((received := self.next_message()).message):
            pass
        return received

    def _silence(self, seconds: float) -> str:
        publishers = self._session.node.count_publishers(self.topic)
        who = f"{publishers or 'no'} publisher{'' if publishers == 1 else 's'} on it."
        return f"No message on {self.topic} for {seconds:g} s; {who}"

    def _type_on_graph(self, *, wait: bool) -> str:
        topics = self._session.observe(values.LOOK_S).topics
        while self.topic not in topics:
            near = did_you_mean(self.topic, topics)
            if not wait:
                raise CommandError(f"Could not determine the type of {self.topic}: nobody uses this topic.{near}")
            sys.stderr.write(f"Waiting for {self.topic}, which nobody uses yet.{near} Ctrl-C ends it.\n")
            topics = self._wait_for_topic()
        if len(topics[self.topic]) > 1:
            raise CommandError(
                f"{self.topic} has the types {', '.join(topics[self.topic])} at once: name the one to listen to."
            )
        return topics[self.topic][0]

    def _wait_for_topic(self) -> dict[str, list[str]]:
        found: dict[str, list[str]] = {}

        def is_there() -> bool:
            found.update(self._session.node.get_topic_names_and_types())
            return self.topic in found

        timeout = math.inf if self.options.timeout is None else self.options.timeout
        if not self._session.wait_on_graph(is_there, timeout):
            raise CommandError(f"{self.topic} has not appeared within {timeout:g} s.")
        return found

    def _field(self, message: Any) -> Any:
        for name in filter(None, (self.options.field or "").split(".")):
            known: dict[str, str] = getattr(message, "get_fields_and_field_types", dict)()
            if name not in known:
                raise CommandError(f"There is no field {name!r} in the message.{did_you_mean(name, known)}")
            message = getattr(message, name)
        return message


def _profile(options: Namespace, otherwise: QoSProfile) -> QoSProfile:
    """The quality of service the options ask for; `otherwise` where they name no profile."""
    profile = otherwise
    if options.qos_profile == "default":
        profile = QoSProfile(depth=10)
    elif options.qos_profile is not None:
        profile = QoSPresetProfiles.get_from_short_key(options.qos_profile)
    profile = QoSProfile(
        depth=profile.depth,
        history=profile.history,
        reliability=profile.reliability,
        durability=profile.durability,
    )
    if options.qos_depth is not None:
        if options.qos_depth < 0:
            raise CommandError(f"--qos-depth must be a number of messages, not {options.qos_depth}.")
        profile.depth = options.qos_depth
    for name in ("reliability", "durability", "history"):
        if wanted := getattr(options, f"qos_{name}"):
            policies = type(getattr(profile, name))
            setattr(profile, name, policies[wanted.upper()])
    return profile


def print_rate(listener: Listener) -> None:
    """Print once a second how often messages have come, over the last `window` of them."""
    listener.subscribe(wait=True)
    for times in _collect(listener, listener.options.window + 1, lambda received: received.at, least=2):
        gaps = [later - earlier for earlier, later in pairwise(times)]
        mean = sum(gaps) / len(gaps)
        print(f"average rate: {1.0 / mean if mean else math.inf:.3f}\n\t{_spread(gaps)}", flush=True)


def print_delay(listener: Listener) -> None:
    """Print once a second how old messages are when they come, by the stamp in their header."""

    def delay_of(received: ReceivedMessage) -> float:
        stamp = getattr(getattr(received.message, "header", None), "stamp", None)
        if stamp is None:
            raise CommandError(
                "msg does not have header: only messages with a std_msgs/Header say when they were sent."
            )
        return float(received.at - stamp.sec - stamp.nanosec / _NS)

    listener.subscribe(wait=True)
    for delays in _collect(listener, listener.options.window, delay_of):
        print(f"average delay: {sum(delays) / len(delays):.3f}\n\t{_spread(delays)}", flush=True)


def print_bandwidth(listener: Listener) -> None:
    """Print once a second how many bytes come."""
    listener.subscribe(wait=True, raw=True)
    print(f"Subscribed to [{listener.topic}]", flush=True)
    for sizes in _collect(
        listener, listener.options.window, lambda received: (received.at, len(received.message)), least=2
    ):
        print(_bandwidth_line(list(sizes), time.time()), flush=True)


def _collect(
    listener: Listener, window: int, read: Callable[[ReceivedMessage], T], *, least: int = 1
) -> Iterator[deque[T]]:
    """What is read of the last messages, at least so many, once a second and for as long as they come."""
    found: deque[T] = deque(maxlen=window)
    report_at = time.monotonic() + REPORT_EVERY
    while True:
        found.append(read(listener.next_matching()))
        if time.monotonic() >= report_at and len(found) >= least:
            yield found
            report_at = time.monotonic() + REPORT_EVERY


def _bandwidth_line(sizes: list[tuple[float, int]], now: float) -> str:
    numbers = [size for _, size in sizes]
    per_second = sum(numbers) / (now - sizes[0][0])
    unit, name = next(((unit, name) for unit, name in ((1e6, "MB"), (1e3, "KB")) if per_second >= unit), (1.0, "B"))
    digits = 0 if name == "B" else 2

    def format_size(size: float) -> str:
        return f"{size / unit:.{digits}f} {name}"

    mean, least, most = (format_size(size) for size in (sum(numbers) / len(numbers), min(numbers), max(numbers)))
    rate = format_size(per_second)
    return f"{rate}/s from {len(numbers)} messages\n\tMessage size mean: {mean} min: {least} max: {most}"


def _spread(values: deque[float] | list[float]) -> str:
    from statistics import pstdev  # slow to import, and only `hz` and `delay` need it

    return f"min: {min(values):.3f}s max: {max(values):.3f}s std dev: {pstdev(values):.5f}s window: {len(values)}"


VERBS = {"echo": Listener.echo, "hz": print_rate, "delay": print_delay, "bw": print_bandwidth}


def _filter_of(expression: str | None) -> Callable[[Message], bool]:
    """What tells the messages that are wanted: a Python expression of `m`, as somebody has typed it for themselves."""
    if expression is None:
        return lambda _: True
    try:
        code = compile(expression, "--filter", "eval")
    except (SyntaxError, ValueError) as error:
        raise CommandError(f"--filter {expression!r} is not a Python expression: {error}.") from error

    def matches(message: Message) -> bool:
        try:
            return bool(eval(code, {"m": message}))  # noqa: S307 - the user's own words, as in the real command
        except Exception as error:
            raise CommandError(f"--filter {expression!r} has failed: {type(error).__name__}: {error}.") from error

    return matches


def publish_values(options: Namespace, session: Session, topic: str) -> None:
    """Publish as `topic pub` does."""
    if options.rate <= 0:
        raise CommandError(f"--rate must be a number above 0, not {options.rate:g}.")
    times = 1 if options.once else options.times
    wanted = (1 if times else 0) if options.wait_matching_subscriptions is None else options.wait_matching_subscriptions
    if not wanted and options.max_wait is not None:
        raise CommandError("--max-wait-time-secs needs --wait-matching-subscriptions, --once or --times.")
    message_type = values.find_type(options.message_type, "msg")
    given = values.TypedValues(values.read_typed(options, "values"), type_name(message_type))
    message = message_type()
    given.put_into(message)
    if options.node_name:
        session.call_node(options.node_name)
    publisher = session.node.create_publisher(message_type, topic, _profile(options, QoSProfile(depth=10)))
    _wait_for_subscriptions(publisher, topic, wanted, options, session)
    print("publisher: beginning loop", flush=True)
    count = 0
    while True:
        count += 1
        if count > 1 and given.are_of_the_moment:
            given.put_into(message)
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
        if session.wait_on_graph(lambda: publisher.get_subscription_count() >= wanted, min(left, REPORT_EVERY)):
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

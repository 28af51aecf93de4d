"""Live types in running nodes: bad payloads, service introspection, type descriptions, threads, memory."""

from __future__ import annotations

import copy
import gc
import os
import pickle
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from course_interfaces.action import MoveRobot
from example_interfaces.msg import Float64MultiArray, MultiArrayDimension, MultiArrayLayout
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import Point
from rclpy.serialization import deserialize_message, serialize_message
from type_description_interfaces.srv import GetTypeDescription

from course_kit import environment, interfaces
from course_kit.interfaces.type_description import type_hash
from tests.interfaces.spun import Spun

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

THREADS = Path(__file__).with_name("threads.py")


@pytest.fixture
def spun(domain: int) -> Iterator[Spun]:
    made = Spun(domain, "live")
    yield made
    made.close()


def add(request: Any, response: Any) -> Any:
    response.sum = request.a + request.b
    return response


def test_a_subscription_survives_malformed_payloads(spun: Spun) -> None:
    got: list[Any] = []
    spun.node.create_subscription(Float64MultiArray, "array", got.append, 10)
    publisher = spun.node.create_publisher(Float64MultiArray, "array", 10)
    spun.wait_for(publisher.get_subscription_count, "the subscription")
    layout = MultiArrayLayout(dim=[MultiArrayDimension(label="height", size=2)])
    good = Float64MultiArray(layout=layout, data=[1.0, 2.0])
    payload = serialize_message(good)
    bad = [payload[:30], payload[:9] + b"\xff\xff\xff\x7f" + payload[13:], b"\0\x09\0\0" + payload[4:], payload * 2]
    for malformed in bad:
        publisher.publish(malformed)
        publisher.publish(good)
    spun.wait_for(lambda: len(got) >= len(bad), "the good messages")
    assert got == [good] * len(bad)


def test_the_node_describes_live_types(spun: Spun) -> None:
    spun.node.create_service(AddTwoInts, "add", add)
    client = spun.node.create_client(GetTypeDescription, "live/get_type_description")
    digest = "RIHS01_" + type_hash(AddTwoInts).hex()
    name = "example_interfaces/srv/AddTwoInts"
    request = GetTypeDescription.Request(type_name=name, type_hash=digest, include_type_sources=True)
    answer = spun.answer(client, request)
    assert answer.successful, answer.failure_reason
    described = answer.type_description
    assert [field.name for field in described.type_description.fields] == [
        "request_message",
        "response_message",
        "event_message",
    ]
    assert {part.type_name for part in described.referenced_type_descriptions} >= {
        f"{name}_Request",
        "service_msgs/msg/ServiceEventInfo",
        "builtin_interfaces/msg/Time",
    }
    sources = {source.type_name: source for source in answer.type_sources}
    assert sources[name].raw_file_contents == interfaces.text_of(name)
    assert sources[name].encoding == "srv"
    assert sources["builtin_interfaces/msg/Time"].encoding == "msg"
    assert sources[f"{name}_Request"].encoding == "implicit"


def test_messages_can_be_copied_and_pickled() -> None:
    goal = MoveRobot.Goal(target=Point(x=1.0))
    deep = copy.deepcopy(goal)
    assert deep == goal
    assert deep.target is not goal.target
    assert copy.copy(goal).target is goal.target
    assert pickle.loads(pickle.dumps(goal)) == goal  # noqa: S301 - our own
    with pytest.raises(TypeError, match="unhashable"):
        hash(goal)
    with pytest.raises(NotImplementedError, match=r"Write MoveRobot\.Goal"):
        MoveRobot(target=Point(x=1.0))
    with pytest.raises(NotImplementedError, match="Service classes can not be instantiated"):
        AddTwoInts()


@pytest.mark.usefixtures("domain")
def test_many_threads_with_a_small_switch_interval() -> None:
    """With callbacks into Python under the locks of Fast DDS this hung each time; see native/helper.c."""
    done = subprocess.run(
        [sys.executable, str(THREADS)],
        env=environment.child_environment(),
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout == "published 8000, answered 400\n"


def resident_kilobytes() -> int:
    gc.collect()
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") // 1024


def steady(action: Callable[[], object], rounds: int) -> tuple[int, int]:
    """How much memory, in kB and in Python's blocks, some rounds of an action keep after a warm-up."""
    for _ in range(rounds):
        action()
    kilobytes, blocks = resident_kilobytes(), sys.getallocatedblocks()
    for _ in range(rounds):
        action()
    return resident_kilobytes() - kilobytes, sys.getallocatedblocks() - blocks


def test_memory_stays_flat_over_conversions() -> None:
    message = MoveRobot.Result(message="x" * 200, final_position=Point(x=1.0))
    payload = serialize_message(message)

    wrong = MoveRobot.Feedback()
    wrong._progress = "half"

    def convert() -> None:
        deserialize_message(serialize_message(message), MoveRobot.Result)
        with pytest.raises(TypeError):
            serialize_message(wrong)
        with pytest.raises(Exception, match="deserialize"):
            deserialize_message(payload[:20], MoveRobot.Result)

    kilobytes, blocks = steady(convert, 4000)
    assert kilobytes < 500
    assert blocks < 2000  # less than one object in two rounds

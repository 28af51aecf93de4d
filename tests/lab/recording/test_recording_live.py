"""The recorder on real nodes."""

from __future__ import annotations

import asyncio
import re
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

from course_kit import lab
from tests.lab.nodes import Faulty, Switch

if TYPE_CHECKING:
    from course_kit.lab.recording.events import Recording


@pytest.mark.usefixtures("recording")
def test_calls_and_failures_are_drawn(capsys: pytest.CaptureFixture[str]) -> None:
    lab.start(Switch)
    lab.start(Faulty)
    assert str(lab.diagram()).startswith("Nothing has been recorded yet")
    lab.call_blocking("/switch", SetBool, data=True)
    with pytest.raises(lab.ServiceFailedError):
        lab.call_blocking("/forgets", Trigger)
    faulty = next(live.node for live in lab.nodes() if live.name == "/faulty")
    future = faulty.client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(faulty, future, timeout_sec=10)
    lines = re.sub(r"\n +", " ", str(lab.diagram())).splitlines()
    assert lines == [
        "1. lab -> switch  /switch request: data=True",
        "2. switch -> lab  /switch response: success=True, message='first'",
        "3. lab -> faulty  /forgets request: (empty)",
        "4. faulty --x lab  /forgets no answer: the service callback returned nothing. End it with `return response`.",
        "5. faulty -> faulty  /fine request: (empty)",
        "6. faulty -> faulty  /fine response: success=True, message=''",
    ]
    lab.record()
    assert str(lab.diagram()).startswith("Nothing has been recorded yet")
    assert capsys.readouterr().err


def test_topics_are_drawn(recording: Recording) -> None:
    class Listener(Switch):
        def __init__(self) -> None:
            super().__init__("listener")
            self.create_subscription(String, "/said", self.hear, 10)
            self.publisher = self.create_publisher(String, "/echo", 10)

        def hear(self, message: Any) -> None:
            self.publisher.publish(message)

    async def exchange() -> None:
        waiting = asyncio.ensure_future(lab.next_messages("/echo", String))
        await asyncio.sleep(0)
        lab.publish("/said", String, data="hello")
        await waiting

    lab.start(Listener)
    asyncio.run(exchange())
    assert str(lab.diagram()) == "1. lab -> listener  /said data='hello'\n2. listener -> lab  /echo data='hello'"
    assert recording.events[0].type_name == "std_msgs/msg/String"


def test_the_recording_is_a_copy(recording: Recording) -> None:
    lab.start(Switch)
    request = SetBool.Request(data=True)
    lab.call_blocking("/switch", SetBool, request)
    request.data = False
    assert recording.events[0].value == {"data": True}

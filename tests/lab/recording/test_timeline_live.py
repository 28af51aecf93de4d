"""Time lines of real callbacks: on the lab's threads, and in programs that are stuck for good."""

from __future__ import annotations

import itertools
import re
import threading
from typing import Any

import pytest
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from std_srvs.srv import Trigger

from course_kit import lab
from course_kit.lab.recording import hooks
from course_kit.lab.recording.events import Event
from course_kit.lab.recording.timeline import Timeline
from tests.waiting import wait_until

pytestmark = pytest.mark.usefixtures("recording")

STUCK = """
import rclpy
from rclpy.node import Node
from example_interfaces.srv import AddTwoInts


class Doubler(Node):
    def __init__(self):
        super().__init__("doubler")
        self.client = self.create_client(AddTwoInts, "add")
        self.create_service(AddTwoInts, "double", self.double)

    def double(self, request, response):
        response.sum = self.client.call(AddTwoInts.Request(a=request.a, b=request.a)).sum
        return response


rclpy.init()
rclpy.spin(Doubler())
"""


class Adder(Node):
    def __init__(self) -> None:
        super().__init__("adder")
        self.create_service(AddTwoInts, "add", self.add)

    def add(self, request: Any, response: Any) -> Any:
        response.sum = request.a + request.b
        return response


class Doubler(Node):
    """Gives its thread back while it waits."""

    def __init__(self) -> None:
        super().__init__("doubler")
        self.client = self.create_client(AddTwoInts, "add", callback_group=ReentrantCallbackGroup())
        self.create_service(AddTwoInts, "double", self.double)

    async def double(self, request: Any, response: Any) -> Any:
        response.sum = (await self.client.call_async(AddTwoInts.Request(a=request.a, b=request.a))).sum
        return response


def timeline() -> Timeline:
    found: Any = lab.timeline()
    return found


def test_a_callback_that_awaits_gives_its_thread_back() -> None:
    lab.start(Adder)
    lab.start(Doubler)
    lab.call_blocking("/double", AddTwoInts, a=21)
    wait_until(lambda: all(one.end for one in timeline().busy))
    busy = timeline().busy
    assert {one.lane for one in busy} == {"lab, main thread"}
    said = [f"{one.node} {one.label}" for one in busy]
    first, last = said.index("doubler answers /double"), len(said) - 1 - said[::-1].index("doubler answers /double")
    assert first < said.index("adder answers /add") < last
    for one, other in itertools.pairwise(busy):
        assert one.end is not None
        assert one.begin <= one.end <= other.begin  # one thread is never in two callbacks
    assert timeline().waiting == []


def test_a_request_is_known_also_where_its_answer_came_first(monkeypatch: pytest.MonkeyPatch) -> None:
    find_sequence = hooks._sequence_of
    monkeypatch.setattr(hooks, "_sequence_of", lambda *asked: wait_until(asked[1].done) or find_sequence(*asked))
    lab.start(Adder)
    lab.call_blocking("/add", AddTwoInts, a=21)
    assert timeline().waiting == []


def test_a_goal_has_a_thread_of_its_own_and_a_timer_goes_on_meanwhile() -> None:
    beats = threading.Semaphore(0)

    class Cart(Node):
        def __init__(self) -> None:
            super().__init__("cart")
            self.create_timer(0.01, self.beat)
            self.server = ActionServer(self, Fibonacci, "drive", self.drive)

        def beat(self) -> None:
            beats.release()

        def drive(self, goal: Any) -> Any:
            while beats.acquire(blocking=False):
                pass
            assert beats.acquire(timeout=20)
            goal.succeed()
            return Fibonacci.Result()

    lab.start(Cart)
    lab.record()
    lab.send_goal_blocking("/drive", Fibonacci, order=1).result_blocking()
    wait_until(lambda: any(one.lane == "lab, goal thread" and one.end for one in timeline().busy))
    lab.stop()
    busy = timeline().busy
    drive = next(one for one in busy if one.lane == "lab, goal thread")
    assert drive.label == "executes a goal of /drive"
    assert drive.end is not None
    beating = [one for one in busy if one.label == "timer beat"]
    assert any(drive.begin <= one.begin <= drive.end for one in beating)
    assert str(timeline()).splitlines().count("    cart timer beat") == 1


def test_a_deadlock_shows_as_a_callback_that_does_not_end_and_an_answer_that_nobody_takes() -> None:
    lab.start(Adder)
    lab.script("doubler", STUCK)
    lab.record()
    with pytest.raises(lab.NoAnswerError):
        lab.call_blocking("/double", AddTwoInts, a=21, timeout=1.0)
    wait_until(lambda: "the response of /add, which nobody has handled" in str(timeline()), lambda: str(timeline()))
    assert str(timeline()) == (
        "program of doubler, main thread\n"
        "    doubler answers /double, and has not ended\n"
        "lab, main thread\n"
        "    adder answers /add\n"
        "waiting to be handled\n"
        "    the response of /add, which nobody has handled"
    )
    html = timeline()._repr_mimebundle_()["text/html"]
    assert "1 callback has not ended. 1 message is not handled." in html
    assert re.search(r"doubler answers /double, and has not ended: from 0 ms on", html)
    assert not re.findall(r"https?:|<script|url\(|@import", html)


def test_a_callback_that_fails_is_marked(capsys: pytest.CaptureFixture[str]) -> None:
    class Broken(Node):
        def __init__(self) -> None:
            super().__init__("broken")
            self.create_service(Trigger, "fail", self.fail)

        def fail(self, request: Any, response: Any) -> Any:
            del request, response
            raise ValueError("no")

    lab.start(Broken)
    with pytest.raises(lab.ServiceFailedError):
        lab.call_blocking("/fail", Trigger)
    wait_until(lambda: all(one.end for one in timeline().busy))
    assert str(timeline()) == "lab, main thread\n    broken answers /fail, and fails"
    assert "ValueError" in capsys.readouterr().err


def test_nothing_recorded_is_said_and_a_new_recording_forgets() -> None:
    assert str(timeline()) == "No callback has run yet since the recording began."
    lab.start(Adder)
    lab.call_blocking("/add", AddTwoInts, a=1, b=2)
    wait_until(lambda: "adder answers /add" in str(timeline()))
    lab.record()
    assert "text/html" not in timeline()._repr_mimebundle_()


def drawn(*spans: tuple[str, float, float]) -> str:
    """A program whose thread was in callbacks: of which node, and from when to when, in milliseconds."""
    what = {"what": "service", "thread": "MainThread", "ident": 1, "process": 1, "failed": False}
    seen = []
    for number, (node, *times) in enumerate(spans):
        for kind, at in zip(("callback_begun", "callback_ended"), times, strict=True):
            seen.append(Event(kind, node, "/x", "std_srvs/srv/Trigger", what, number, int(at * 1_000_000)))
    return Timeline([], seen).html()


def test_the_text_of_a_short_bar_lies_over_no_other_bar() -> None:
    html = drawn(*((f"/{one}", one, one + 0.1) for one in (0.0, 0.2, 5.3, 5.7)), ("/long", 0.4, 5.2))
    assert re.search(r'class="ck-lane" x="0"[^>]*>[^<]*main thread<', html)  # it takes no room from the bars
    bar = r'(?s)<rect x="(\d+)" y="(\d+)" width="(\d+)".*?<text x="(\d+)".*? y="(\d+)" .*?>(\S+) '
    found = re.findall(bar, html)
    assert [int(x) for x, *_ in found][:2] == [1, 1 + round(540 * 0.2 / 5.8)]
    for x, y, width, text_x, text_y, node in found:
        assert int(text_x) in (int(x), int(x) + int(width))
        assert (int(text_y) < int(y)) is (node == "long")  # the others stand below, each beside a line from its bar
    assert len({text_y for *_, text_y, node in found if node != "long"}) == 2

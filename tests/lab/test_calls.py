from __future__ import annotations

import asyncio
import re
import sys
import time
import weakref
from typing import TYPE_CHECKING, Any

import pytest
import rclpy
from example_interfaces.action import Fibonacci
from geometry_msgs.msg import Point, Pose
from rclpy.action import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger

from course_kit import lab
from course_kit.lab.calls import message_of
from course_kit.lab.overrides import rclpy_functions
from tests.lab.nodes import Faulty, OwnBaseError, Raising, SpeechlessError, Switch, Talker
from tests.ros.two_nodes import TwoNodes

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab

pytestmark = pytest.mark.usefixtures("own_lab")


def call(service: str, kind: Any = Trigger, timeout: float = 5.0, **fields: Any) -> Any:
    return asyncio.run(lab.call(service, kind, timeout=timeout, **fields))


def test_a_call_returns_the_response() -> None:
    lab.start(Switch)
    assert call("/switch", SetBool, data=True).success is True
    assert call("switch", SetBool, data=False).success is False
    ready = SetBool.Request(data=True)
    assert lab.call_blocking("/switch", SetBool, ready).success is True


def test_a_call_passes_at_most_twelve_modules_of_the_lab_and_of_ros(own_lab: Lab) -> None:
    own_lab.record()
    lab.start(Switch)
    call("/switch", SetBool, data=True)
    passed: set[str] = set()

    def note(frame: Any, *_: object) -> None:
        passed.add(frame.f_code.co_filename)

    own_lab.engine.executor_thread.ask(lambda: sys.setprofile(note), 5.0)
    sys.setprofile(note)
    call("/switch", SetBool, data=False)
    sys.setprofile(None)
    assert len([file for file in passed if "/course_kit/lab/" in file or "/course_kit/ros/" in file]) <= 12, passed


def test_many_calls_at_once_get_their_own_answers() -> None:
    lab.start(Switch)

    async def several() -> list[Any]:
        return await asyncio.gather(*(lab.call("/switch", SetBool, data=number % 2 == 0) for number in range(8)))

    assert [answer.success for answer in asyncio.run(several())] == [True, False] * 4


def test_a_program_does_not_keep_each_verb_that_it_forgets_to_await() -> None:
    forgotten = [weakref.ref(lab.call("/never", Trigger)) for _ in range(2_000)]
    assert sum(verb() is not None for verb in forgotten) <= 1_000


def test_a_misspelt_name_gets_the_nearest_one() -> None:
    lab.start(Switch)
    with pytest.raises(lab.ServiceNotFoundError, match=r"No node serves /swich \(waited 0.3 s\).*/switch \[std_srvs"):
        call("/swich", SetBool, timeout=0.3)


def test_another_type_is_named() -> None:
    lab.start(Switch)
    expected = "/switch has the type std_srvs/srv/SetBool, but you called it with std_srvs/srv/Trigger"
    with pytest.raises(lab.ServiceNotFoundError, match=expected):
        call("/switch", Trigger)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"dat": True}, r"no field 'dat' in a std_srvs/srv/SetBool request; it has data. Did you mean 'data'"),
        ({"data": 1}, r"'data' in .* has the type bool and takes True or False; it was given 1, an int"),
    ],
)
def test_wrong_fields(fields: dict[str, Any], message: str) -> None:
    lab.start(Switch)
    with pytest.raises(lab.FieldError, match=message):
        call("/switch", SetBool, **fields)


@pytest.mark.parametrize(
    ("kind", "fields", "message"),
    [
        (Point, {"x": 20}, r"takes a float: write 20\.0"),
        (String, {"data": 5}, "takes a str"),
        (Pose, {"position": {"x": 1.0, "q": 2.0}}, "no field 'q' in position"),
        (Pose, {"position": 3}, "a dict of its fields"),
    ],
)
def test_wrong_values(kind: Any, fields: dict[str, Any], message: str) -> None:
    with pytest.raises(lab.FieldError, match=message):
        message_of(kind, None, fields)


@pytest.mark.parametrize("kind", [SetBool.Request, String, "SetBool", 3])
def test_what_is_no_service_type(kind: Any) -> None:
    with pytest.raises(lab.FieldError, match="is not a service type"):
        call("/switch", kind)


def test_names_that_ros_refuses() -> None:
    with pytest.raises(lab.LabError, match="'add two' is not a ROS name"):
        call("add two")
    with pytest.raises(lab.LabError, match="name comes first"):
        call(SetBool, SetBool)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("service", "reason"),
    [
        ("raises", "faulty sent no response: raises raised RuntimeError: the sensor is unplugged"),
        ("exits", "exits raised SystemExit: 3"),
        ("forgets", "forgets returned nothing. End it with `return response`."),
        ("returns_number", "returned int, which is not a response of std_srvs/srv/Trigger"),
        ("returns_request", "returned the request"),
        ("calls", r"call\(\) of /fine inside a callback would wait for ever"),
        ("spins", r"rclpy.spin_until_future_complete\(\) inside a callback would wait for ever"),
        ("waits", "share one callback group"),
    ],
)
def test_a_callback_without_a_response_fails_its_caller_at_once(
    service: str, reason: str, capsys: pytest.CaptureFixture[str]
) -> None:
    lab.start(Faulty)
    with pytest.raises(lab.ServiceFailedError, match=reason):
        call(service, timeout=30)
    shown = capsys.readouterr().err
    assert shown.startswith(f"faulty: {service} ")
    assert re.search(reason.removeprefix("faulty sent no response: "), shown)
    assert "nodes.py, line " in shown
    assert call("fine").success is True  # the others live on


@pytest.mark.parametrize("error", [KeyboardInterrupt, asyncio.CancelledError, OwnBaseError, SpeechlessError])
def test_whatever_a_callback_raises_is_told_at_once(
    error: type[BaseException], capsys: pytest.CaptureFixture[str]
) -> None:
    assert lab.start(Raising, error).ticked.wait(10)
    for service in ("fails", "fails_later"):
        with pytest.raises(lab.ServiceFailedError, match=f"{service} raised {error.__name__}"):
            call(service, timeout=30)
    shown = capsys.readouterr().err
    for callback in ("fails", "fails_later", "tick"):
        assert f"raising: {callback} raised {error.__name__}" in shown
    assert "Traceback" not in shown


def test_more_calls_at_once_than_a_service_keeps_are_all_answered() -> None:
    node = lab.start(Faulty)
    assert call("/fine").success  # the client is there: what follows is sent at once
    blocker = node.create_client(Trigger, "blocks")
    assert blocker.wait_for_service(10)
    blocker.call_async(Trigger.Request())  # while it runs, nothing is taken

    async def twenty() -> list[Any]:
        calls = [asyncio.ensure_future(lab.call("/fine", Trigger)) for _ in range(20)]
        await asyncio.sleep(0)
        node.release.set()
        return await asyncio.gather(*calls)

    assert [answer.success for answer in asyncio.run(twenty())] == [True] * 20


def test_a_request_that_was_lost_is_not_said_to_be_at_work() -> None:
    node = lab.start(Faulty)
    assert call("/fine").success
    blocker = node.create_client(Trigger, "blocks")
    assert blocker.wait_for_service(10)
    assert node.client.wait_for_service(10)
    blocker.call_async(Trigger.Request())

    async def lost() -> Any:
        asked = asyncio.ensure_future(lab.call("/fine", Trigger, timeout=1.0))
        await asyncio.sleep(0)
        for _ in range(10):  # the service keeps these, and drops the one before
            node.client.call_async(Trigger.Request())
        node.release.set()
        return await asked

    with pytest.raises(lab.NoAnswerError, match="none of its callbacks is at work: the request or its response was lo"):
        asyncio.run(lost())


def test_an_error_repeated_by_a_timer_is_shown_three_times(capsys: pytest.CaptureFixture[str]) -> None:
    class Broken(Talker):
        def tick(self) -> None:
            super().tick()
            raise KeyError("map")

    node = lab.start(Broken)
    asyncio.run(lab.next_messages("/count", String, 10))
    lab.stop(node)
    shown = capsys.readouterr().err
    assert shown.count("talker: tick raised KeyError: 'map'") == 3
    assert shown.count("will not be shown again") == 1


def test_a_slow_callback_is_named_when_time_is_over() -> None:
    faulty = lab.start(Faulty)
    with pytest.raises(
        lab.NoAnswerError, match=r"within 0.5 s. faulty has been in blocks \(nodes.py, line \d+: self.rel"
    ):
        call("blocks", timeout=0.5)
    faulty.release.set()


@pytest.mark.usefixtures("own_lab")
def test_an_answer_that_nobody_can_give_is_not_awaited_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    class Asker(Node):
        def __init__(self) -> None:
            super().__init__("asker")
            self.asked = self.create_client(Trigger, "/never")
            self.goals = ActionClient(self, Fibonacci, "/nowhere")

    monkeypatch.setattr(rclpy_functions, "_NO_SERVER_S", 0.2)
    asker = lab.start(Asker)

    async def wait_for(asked: Any) -> None:
        await asked

    with pytest.raises(lab.ServiceNotFoundError, match=r"No node serves /never \(waited 0\.2 s\)\."):
        asyncio.run(wait_for(asker.asked.call_async(Trigger.Request())))
    with pytest.raises(lab.ActionNotFoundError, match=r"No node runs the action /nowhere"):
        asyncio.run(wait_for(asker.goals.send_goal_async(Fibonacci.Goal())))


def test_a_server_that_goes_away_ends_the_wait(own_lab: Lab) -> None:
    lab.start(Faulty)

    async def ask() -> None:
        asked = asyncio.ensure_future(lab.call("/waits_for_nobody", Trigger, timeout=30))
        await asyncio.sleep(0)
        await asked

    class Silent(Switch):
        def __init__(self) -> None:
            super().__init__("silent")
            self.create_service(Trigger, "/waits_for_nobody", self.wait_long)

        async def wait_long(self, _request: Any, response: Any) -> Any:
            never = self.create_client(Trigger, "/never", callback_group=ReentrantCallbackGroup())
            await never.call_async(Trigger.Request())
            return response

    silent = lab.start(Silent)
    stopper = own_lab.engine.node.create_timer(0.3, lambda: own_lab.engine.nodes.stop_soon(silent))
    with pytest.raises(lab.NoAnswerError, match="went away: its program ended"):
        asyncio.run(ask())
    stopper.cancel()


def test_awaiting_a_clients_future_uses_no_time() -> None:
    faulty = lab.start(Faulty)

    async def wait() -> float:
        before = time.thread_time()
        future = faulty.client.call_async(Trigger.Request())
        assert (await future).success is True
        blocked = faulty.create_client(Trigger, "blocks").call_async(Trigger.Request())
        with pytest.raises(asyncio.TimeoutError):
            await asyncio.wait_for(as_coroutine(blocked), 0.5)
        return time.thread_time() - before

    async def as_coroutine(future: Any) -> Any:
        return await future

    assert asyncio.run(wait()) < 0.2  # rclpy's own future would take the whole half second
    faulty.release.set()


def test_rclpys_functions_in_a_cell_leave_the_node_to_the_lab() -> None:
    node = lab.start(Faulty)
    future = node.client.call_async(Trigger.Request())
    rclpy.spin_until_future_complete(node, future, timeout_sec=5)
    assert future.result().success is True
    future = node.client.call_async(Trigger.Request())
    deadline = time.monotonic() + 10
    while not future.done() and time.monotonic() < deadline:
        rclpy.spin_once(node)
    assert future.result().success is True
    rclpy.spin(node)
    executor = SingleThreadedExecutor()
    assert executor.add_node(node) is False
    executor.shutdown()
    rclpy.init()
    rclpy.shutdown()
    assert call("fine").success is True
    assert node.client.call(Trigger.Request()).success is True


def test_spinning_takes_the_node_out_of_its_executor_as_in_a_program(own_lab: Lab) -> None:
    assert own_lab.engine
    node, executor = rclpy.create_node("mine"), SingleThreadedExecutor()
    executor.add_node(node)
    node.create_timer(0.01, lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        rclpy.spin(node, executor)
    assert executor.get_nodes() == []
    node.destroy_node()


def test_shutdown_in_a_callback_stops_that_node_only(own_lab: Lab) -> None:
    class Quits(Switch):
        def answer(self, request: Any, response: Any) -> Any:
            rclpy.shutdown()
            return super().answer(request, response)

    lab.start(Talker)
    lab.start(Quits)
    assert call("/switch", SetBool, data=True).success is True
    assert own_lab.engine.executor_thread.run_between_callbacks(lambda: None, 10)
    assert [live.name for live in lab.nodes()] == ["/talker"]


def test_the_lab_refuses_to_be_waited_for_in_a_callback(capsys: pytest.CaptureFixture[str]) -> None:
    class Asks(Switch):
        def answer(self, _request: Any, _response: Any) -> Any:
            return lab.call_blocking("/fine", Trigger)

    lab.start(Asks)
    with pytest.raises(lab.ServiceFailedError, match=r"lab.call_blocking\(\) inside a callback"):
        call("/switch", SetBool)
    assert "switch: answer was stopped" in capsys.readouterr().err


def test_topics() -> None:
    lab.start(Talker)
    numbers = [int(message.data) for message in asyncio.run(lab.next_messages("/count", String, 3))]
    assert numbers == list(range(numbers[0], numbers[0] + 3))

    heard: list[str] = []

    class Listener(Switch):
        def __init__(self) -> None:
            super().__init__("listener")
            self.create_subscription(String, "/said", lambda message: heard.append(message.data), 10)

    lab.start(Listener)
    lab.publish("/said", String, data="hello")
    assert heard == ["hello"]  # its callback has run when publish returns


def test_the_first_message_is_not_lost_where_both_ends_are_on_the_graph(own_lab: Lab) -> None:
    far = TwoNodes(own_lab.engine.executor_thread.context.get_domain_id(), ("far", "other"))
    heard: list[str] = []
    far.nodes[0].create_subscription(String, "/there", lambda message: heard.append(message.data), 10)
    publisher = far.nodes[0].create_publisher(String, "/back", 10)
    node = own_lab.engine.node
    far.spin_until(lambda: node.count_subscribers("/there") == 1 == node.count_publishers("/back"))
    lab.publish("/there", String, data="there")
    far.spin_until(lambda: bool(heard))
    lab.subscribe("/back", String, lambda message: heard.append(message.data))
    far.spin_until(lambda: publisher.get_subscription_count() == 1)  # its side may hear of it a moment later
    publisher.publish(String(data="back"))
    far.spin_until(lambda: heard == ["there", "back"])
    far.close()


def test_no_message_says_why() -> None:
    with pytest.raises(lab.NoAnswerError, match=r"No message came on /count within 0\.2 s\. No node publishes it"):
        asyncio.run(lab.next_messages("/count", String, timeout=0.2))
    with pytest.raises(lab.FieldError, match="is not a message type"):
        asyncio.run(lab.next_messages("/count", SetBool, timeout=0.2))
    with pytest.raises(lab.FieldError, match="no field 'text'"):
        lab.publish("/count", String, text="x")


def test_what_notebooks_tell_each_other_costs_no_call_anything(own_lab: Lab) -> None:
    """Each event handler is looked at in each turn of the executor; eight of them made a call a fifth slower."""
    ends = [*own_lab.engine.node.publishers, *own_lab.engine.node.subscriptions]
    told = {end.topic_name: len(end.event_handlers) for end in ends}
    assert "/_lab/stop" in told
    assert {count for topic, count in told.items() if topic.startswith("/_lab/")} == {0}

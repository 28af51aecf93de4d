"""The lab and the graders on later versions of rclpy, as far as these behave in another way.

What is installed here is rclpy 7.1.6; later ones are stood in for, see `later_rclpy`.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Trigger

from course_kit import lab
from course_kit.lab import NoAnswerError, ServiceFailedError
from tests.lab.fresh import fresh_lab
from tests.ros import later_rclpy
from tests.ros.nodes import Everything
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.lab.runtime.core import Lab


@pytest.fixture
def later_lab(domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[Lab]:
    """A lab on the way that later ones await futures."""
    assert domain
    later_rclpy.await_as_in_7_1_9(monkeypatch)
    later_rclpy.refuse_a_second_spin_as_in_7_1_9(monkeypatch)
    with fresh_lab() as mine:
        yield mine


class Asking(Node):
    """Awaits /add_two_ints twice in each of its callbacks."""

    def __init__(self, group: Any = None) -> None:
        super().__init__("asking")
        group = group or ReentrantCallbackGroup()
        self.news = Future()
        self.client = self.create_client(AddTwoInts, "add_two_ints", callback_group=group)
        self.create_service(AddTwoInts, "add_twice", self.add, callback_group=group)
        self.create_subscription(String, "orders", self.obey, 10, callback_group=group)
        ActionServer(self, Fibonacci, "count", self.execute, callback_group=group)

    async def sum_of(self, a: int, b: int) -> int:
        first = await self.client.call_async(AddTwoInts.Request(a=a, b=b))
        second = await self.client.call_async(AddTwoInts.Request(a=first.sum, b=b))
        return int(second.sum)

    async def add(self, request: Any, response: Any) -> Any:
        response.sum = await self.sum_of(request.a, request.b)
        if response.sum == 0:
            raise ValueError("nothing")
        return response

    async def obey(self, message: Any) -> None:
        await self.sum_of(1, 1)
        raise SystemExit(message.data) if message.data == "exit" else ValueError(message.data)

    async def execute(self, goal: Any) -> Any:
        if goal.request.order == 0:
            await self.news
        total = await self.sum_of(goal.request.order, 1)
        goal.succeed()
        return Fibonacci.Result(sequence=[total])


def test_a_callback_that_awaits_twice_answers(later_lab: Lab) -> None:
    assert later_lab.live_nodes() == []
    lab.start(Everything)
    lab.start(Asking)
    assert lab.call_blocking("/add_twice", AddTwoInts, a=1, b=2).sum == 5


def test_what_a_callback_raises_after_an_await_is_told_once_and_to_its_caller(
    later_lab: Lab, capsys: pytest.CaptureFixture[str]
) -> None:
    lab.start(Everything)
    lab.start(Asking)
    with pytest.raises(ServiceFailedError, match="asking sent no response: add raised ValueError: nothing"):
        lab.call_blocking("/add_twice", AddTwoInts, a=0, b=0)
    told = capsys.readouterr().err
    assert told.count("asking: add raised ValueError: nothing") == 1
    assert lab.call_blocking("/add_twice", AddTwoInts, a=1, b=2).sum == 5
    assert later_lab.engine.executor_thread.executor.callback_run is None


def test_an_execute_callback_that_awaits_ends_with_its_node_and_leaves_nothing(later_lab: Lab) -> None:
    lab.start(Everything)
    lab.start(Asking)
    goal = lab.send_goal_blocking("/count", Fibonacci, order=0)
    lab.stop(Asking)
    with pytest.raises(NoAnswerError, match="went away: its program ended"):
        goal.result_blocking(timeout=10)
    executor = later_lab.engine.executor_thread.executor
    wait_until(lambda: not executor._begun)


def test_an_execute_callback_that_awaits_keeps_the_thread_free_until_its_future_is_done(later_lab: Lab) -> None:
    lab.start(Everything)
    node = lab.start(Asking)
    goal = lab.send_goal_blocking("/count", Fibonacci, order=0)
    executor = later_lab.engine.executor_thread.executor
    turns = [0]
    run_handler = executor._run_handler

    def counted(*arguments: Any) -> None:
        turns[0] += 1
        run_handler(*arguments)

    executor._run_handler = counted
    assert lab.call_blocking("/add_twice", AddTwoInts, a=1, b=2).sum == 5
    assert turns[0] < 200
    node.news.set_result(None)
    executor.wake()
    assert list(goal.result_blocking(timeout=10).sequence) == [2]


class WithoutExecuteCallback(Node):
    """Ends its goals when its service is called."""

    def __init__(self) -> None:
        super().__init__("counter")
        self.goals: list[Any] = []
        self.server = ActionServer(self, Fibonacci, "count", handle_accepted_callback=self.goals.append)
        self.create_service(Trigger, "end", self.end)

    def end(self, request: Any, response: Any) -> Any:
        del request
        for goal in self.goals:
            goal.execute()
            goal.succeed(Fibonacci.Result(sequence=[7]))
        return response


@pytest.fixture
def lab_with_goals_that_others_end(domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[Lab]:
    assert domain
    later_rclpy.do_without_execute_callback_as_in_7_1_8(monkeypatch)
    with fresh_lab() as mine:
        mine.record()
        yield mine


@pytest.mark.usefixtures("lab_with_goals_that_others_end")
def test_a_server_without_an_execute_callback_ends_its_goals_and_is_recorded() -> None:
    lab.start(WithoutExecuteCallback)
    goal = lab.send_goal_blocking("/count", Fibonacci, order=1)
    with pytest.raises(NoAnswerError, match="counter has not ended the goal, and no execute callback is running"):
        goal.result_blocking(timeout=0.5)
    lab.call_blocking("/end", Trigger)
    assert list(goal.result_blocking(timeout=10).sequence) == [7]
    assert "/count result: SUCCEEDED, sequence=[7]" in str(lab.diagram())


SPINS = """\
Traceback (most recent call last):
  File "submission.py", line 9, in <module>
    main()
  File "site-packages/rclpy/executors.py", line 630, in handler
    await call_coroutine()
  File "site-packages/rclpy/{outer}", line 359, in {function}
    result = await await_or_execute(callback, goal_handle)
  File "site-packages/rclpy/executors.py", line 108, in await_or_execute
    return callback(*args)
  File "submission.py", line 2, in convert
    rclpy.spin_until_future_complete(self, future)
  File "site-packages/rclpy/executors.py", line 221, in _enter_spin
    raise RuntimeError('Executor is already spinning')
RuntimeError: Executor is already spinning
"""


@pytest.mark.parametrize(
    ("function", "outer"),
    [("explain_call", "_execute"), ("explain_end", "_execute"), ("explain_program", "_execute_goal")],
)
def test_a_callback_that_spins_is_a_deadlock_whether_it_hangs_or_is_refused(function: str, outer: str) -> None:
    from course_kit.grading.diagnosis import causes
    from course_kit.grading.model.job import Job
    from course_kit.grading.model.submission import Submission

    life = SimpleNamespace(
        stderr=SPINS.format(outer="action/server.py", function=outer), notes={}, signal=None, limit=None, cpu_s=0.0
    )
    source = "def convert(self):\n    rclpy.spin_until_future_complete(self, future)\n"
    job = Job("", "run", 1, Submission("submission.py", "submission.py", source))
    diagnosis, message = getattr(causes, function)(life, job)
    assert diagnosis == "service.deadlock"
    assert "line 2: rclpy.spin_until_future_complete(self, future)" in message


@pytest.mark.parametrize(
    ("printed", "is_told"),
    [
        ("[WARN] [1.5] [limiter]: Failed to get parameters: undeclared: max_speed\n", False),
        ("[WARN] [1.5] [limiter]: Failed to set parameter: max_speed\n", False),
        ("[WARN] [1.5] [limiter]: max_speed has to be positive\n", True),
        ("[WARN] [1.5] [limiter]: Failed to get parameters: x\nmax_speed is wrong\n", True),
    ],
)
def test_what_rclpy_says_about_requests_is_not_taken_for_the_submissions_words(printed: str, is_told: bool) -> None:
    from course_kit.graders import robot_parameters
    from course_kit.grading.checks.evidence import Evidence, Failed

    class StandInContext:
        program = SimpleNamespace(status=lambda **_: SimpleNamespace(stdout="", stderr=printed))

        def wait_until(self, is_done: Any, _: float, **__: Any) -> bool:
            return bool(is_done())

    evidence = Evidence("started", "a word about it", "the program ended")
    words = ("max_speed", *robot_parameters._WARNINGS)
    if is_told:
        assert robot_parameters._require_words(SimpleNamespace(context=StandInContext()), words, evidence) == evidence
    else:
        with pytest.raises(Failed):
            robot_parameters._require_words(SimpleNamespace(context=StandInContext()), words, evidence)


@pytest.mark.parametrize("written", ["/limiter", "limiter"])
def test_a_parameter_file_may_leave_out_the_slash(written: str, tmp_path: Any) -> None:
    """rclpy's own function takes one form before 7.1.8, and both after it; ours asks it for neither."""
    from course_kit.ros2cli import parameters

    path = tmp_path / "limiter.yaml"
    path.write_text(f"{written}:\n  ros__parameters:\n    max_speed: 1.5\n")
    (parameter,) = parameters.load_parameters(str(path), "/limiter", use_wildcard=True)
    assert (parameter.name, parameter.value.double_value) == ("max_speed", 1.5)

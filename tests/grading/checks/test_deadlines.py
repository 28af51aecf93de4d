"""A check's deadline ends every wait, whichever verb waits, and what is told then is true."""

from __future__ import annotations

import re
import subprocess
import sys
from typing import TYPE_CHECKING, Any
from unittest.mock import Mock

import pytest
from course_interfaces.action import MoveRobot
from course_interfaces.srv import ConvertTemperature

from course_kit import environment
from course_kit.grading.checks import hangs
from course_kit.grading.checks.check import Check, run_all
from course_kit.grading.checks.context import ANSWER_S, CheckContext, SubmissionEndedError, machine
from course_kit.grading.checks.discovery import WantedEndpoint, await_start, expect_endpoints, expect_node
from course_kit.grading.checks.evidence import Evidence, Failed
from course_kit.grading.checks.fair_clock import ProcessorUse
from course_kit.grading.checks.graded_goal import GradedGoal
from course_kit.grading.checks.graded_node import GradedNode
from course_kit.grading.checks.parameters import RemoteParameters
from course_kit.grading.model.job import Job
from course_kit.grading.model.limits import Limits

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

DEADLINE_S = 0.4
START_S = PATIENCE_S = 200.0  # against hanging only
SERVICE = WantedEndpoint("service", "/convert_temperature", "course_interfaces/srv/ConvertTemperature")
MISSING = WantedEndpoint("service", "/not_there", SERVICE.type)
OTHER = WantedEndpoint("publisher", "/other", "geometry_msgs/msg/Twist")
NODE = "/silent"
REQUEST = ConvertTemperature.Request()
EVIDENCE = Evidence("something", "an answer")
# Everything is on the graph, and nothing is ever answered: nobody spins the node.
SILENT = """
import threading
import rclpy
from course_interfaces.action import MoveRobot
from course_interfaces.srv import ConvertTemperature
from geometry_msgs.msg import Twist
from rclpy.action import ActionServer

rclpy.init()
node = rclpy.create_node("silent")
kept = [
    node.create_service(ConvertTemperature, "convert_temperature", print),
    ActionServer(node, MoveRobot, "move_robot", print),
    node.create_subscription(Twist, "cmd_vel_in", print, 10),
    node.create_publisher(Twist, "cmd_vel", 10),
]
threading.Event().wait()
"""


@pytest.fixture(scope="module")
def silent_domain() -> Iterator[int]:
    """A graph with nothing but the silent node."""
    with environment.exclusive_domain() as domain_id:
        environ = environment.child_environment(ROS_DOMAIN_ID=str(domain_id))
        with subprocess.Popen([sys.executable, "-c", SILENT], env=environ) as program:
            yield domain_id
            program.kill()


@pytest.fixture
def context(silent_domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[CheckContext]:
    """A context on that graph."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(silent_domain))
    grader, limits = "course_kit.graders.temperature_service", Limits(start_s=START_S)
    job = Job(grader, "attach", 3, limits=limits, endpoints=(SERVICE,))
    made = CheckContext(None, job)  # type: ignore[arg-type]  # nobody starts anything
    made.launch()
    assert made.wait_until(lambda: NODE in made.grader_node.nodes(), PATIENCE_S)
    assert made.program.start((), {}, {}) or made.program.processor_use().waited_s <= machine.somebody_waited()
    yield made
    made.close()


def send(context: CheckContext) -> GradedGoal:
    return GradedGoal(context, "/move_robot", MoveRobot, MoveRobot.Goal())


def cancel(context: CheckContext) -> None:
    assert not context.wait_until(send(context).cancel()[1].is_answered, ANSWER_S)


# Each asks the silent node for something, and how long it would wait by itself.
VERBS: dict[str, tuple[Callable[[CheckContext], Any], float]] = {
    "call": (lambda context: GradedNode(context).call(SERVICE.name, REQUEST), ANSWER_S),
    "call together": (lambda context: GradedNode(context).call_together(SERVICE.name, [REQUEST] * 20), ANSWER_S),
    "cancel": (cancel, ANSWER_S),
    "result": (lambda context: send(context).wait_for_end(ANSWER_S, "an end"), ANSWER_S),
    "last feedback": (lambda context: send(context).wait_for_last_feedback(lambda _: False), 3.5),
    "parameter values": (lambda context: RemoteParameters(context, NODE).values(["x"]), ANSWER_S),
    "set": (lambda context: RemoteParameters(context, NODE).set_values({"x": 1.0}), ANSWER_S),
    "node that serves its parameters": (lambda context: RemoteParameters(context, NODE).expect_served(), ANSWER_S),
    "endpoints": (lambda context: expect_endpoints(context, [OTHER]), 2.0),
    "service that is missing": (lambda context: expect_endpoints(context, [MISSING]), 2.0),
    "node's name": (lambda context: expect_node(context, "/nobody"), 1.5),
    "start": (lambda context: await_start(context, "a node", lambda: False), START_S),
}


def test_names_may_come_after_topics(context: CheckContext, monkeypatch: pytest.MonkeyPatch) -> None:
    names, early = context.grader_node.nodes, [True] * 3
    monkeypatch.setattr(context.grader_node, "nodes", lambda: [] if early and early.pop() else names())
    with pytest.raises(Failed, match="geometry_msgs/msg/Twist"):
        expect_endpoints(context, [WantedEndpoint("publisher", "/cmd_vel", "std_msgs/msg/Bool")])


@pytest.mark.parametrize("verb", VERBS)
def test_no_verb_waits_beyond_the_deadline(context: CheckContext, verb: str) -> None:
    ask, patience_s = VERBS[verb]
    spent: list[float] = []

    def one(context: CheckContext) -> Evidence:
        clock = context.clock()
        try:
            ask(context)
        finally:
            spent.append(clock.fair_s())
        return EVIDENCE

    (result,) = run_all([Check("one", "One", 1.0, (), DEADLINE_S, one)], context)
    assert result.status in ("failed", "passed"), result.message
    assert spent[0] < patience_s
    if told := re.search(r"within ([\d.]+) s", result.got):
        assert float(told[1]) < patience_s


def test_a_start_is_counted_from_when_the_sandbox_answers(
    context: CheckContext, monkeypatch: pytest.MonkeyPatch
) -> None:
    context.clock()  # it is known how things stood before the start
    monkeypatch.setattr(context.program, "processor_use", look := Mock(return_value=ProcessorUse()))
    is_there = Mock(side_effect=lambda: look.called)
    context.wait_for_start(is_there)
    assert is_there.call_count == 1  # at its first look it is there


def test_the_next_check_has_time_of_its_own(context: CheckContext) -> None:
    waited: list[bool] = []

    def slow(context: CheckContext) -> Evidence:
        waited.append(context.wait_until(lambda: False, ANSWER_S))
        return EVIDENCE

    def quick(context: CheckContext) -> Evidence:
        waited.append(context.wait_until(lambda: NODE in context.grader_node.nodes(), ANSWER_S))
        return EVIDENCE

    checks = [Check("slow", "Slow", 1.0, (), DEADLINE_S, slow), Check("quick", "Quick", 1.0, (), PATIENCE_S, quick)]
    assert [result.status for result in run_all(checks, context)] == ["passed", "passed"]
    assert waited == [False, True]


def test_what_has_come_already_is_asked_for_without_a_wait(
    context: CheckContext, monkeypatch: pytest.MonkeyPatch
) -> None:
    spins: list[float] = []
    monkeypatch.setattr(context.grader_node, "spin_once", spins.append)
    assert not context.wait_until(lambda: False, 0.0)
    assert spins == []


def test_two_clients_send_all_requests_that_are_made_together(
    context: CheckContext, monkeypatch: pytest.MonkeyPatch
) -> None:
    lanes: list[Any] = []

    def keep_lanes(_context: Any, clients: list[Any], messages: list[Any], *_: Any) -> list[Any]:
        lanes.extend(clients)
        return messages

    monkeypatch.setattr(hangs, "call_many", keep_lanes)
    GradedNode(context).call_together(SERVICE.name, [REQUEST] * 20, at_a_time=10)
    assert len(lanes) == 10
    assert len({id(client) for client in lanes}) == 2


def test_a_program_that_ends_while_it_is_watched_is_explained_by_its_end(
    context: CheckContext, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert not hangs.is_computing(context)
    monkeypatch.setattr(context.program, "is_alive", lambda: False)
    with pytest.raises(SubmissionEndedError):
        hangs.is_computing(context)

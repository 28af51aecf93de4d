"""The small steps of the lessons, in the lessons' order. Each function is one check, its docstring what is right."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from course_kit.grading.checks.evidence import in_one_line
from course_kit.grading.checks.ready_made import expect_rate
from course_kit.grading.checks.vocabulary import Evidence, Failed
from course_kit.learner.step_check import LessonStep

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.checks.vocabulary import Change, GradedGoal, GradedNode
    from course_kit.ros.messages import Message

ADD = "example_interfaces/srv/AddTwoInts"
FIBONACCI = "example_interfaces/action/Fibonacci"
FLOAT = "std_msgs/msg/Float64"
MOVE = "action /move_robot course_interfaces/action/MoveRobot"
PERSON = "my_interfaces/srv/PersonInfo"
POSITION = "publisher /position geometry_msgs/msg/Point"
TRIGGER = "std_srvs/srv/Trigger"
_AT_REST = 8  # positions that are the same, of five a second
STEPS: dict[str, LessonStep] = {}


def step(lesson: str, *needs: str) -> Callable[[Callable[[GradedNode], object]], LessonStep]:
    """Make a check a step of a lesson, which needs these on the graph: "service NAME TYPE", ..., or "node NAME"."""

    def register(ask: Callable[[GradedNode], object]) -> LessonStep:
        made = LessonStep(lesson, ask.__name__, (ask.__doc__ or "").strip(), needs, ask)
        STEPS[made.name] = made
        return made

    return register


def expect_soon(node: GradedNode, topic: str, wanted: Callable[[Message], bool], words: str, seconds: float) -> None:
    """The last message of a topic is as wanted, now or within some seconds."""
    inbox, messages = node.inbox(topic), node.inbox(topic).messages
    came = node.context.wait_until(lambda: bool(messages) and wanted(messages[-1]), seconds)
    inbox.heard = inbox.count  # what comes next is newer
    last = in_one_line(messages[-1]) if messages else "nothing"
    node.context.record.begin_exchange().add_received(f"{topic}: {last}", "message")
    if not came:
        raise Failed(Evidence("", "", last), f"{topic} has to say {words}.")


def expect_reason(change: Change, word: str) -> None:
    """A change is refused, and the reason contains a word."""
    change.refused()
    if word not in change.result.reason.lower():
        change.fail(f"The reason does not contain the word {word}.", expected=f"refused, with a reason about {word}")


def expect_feedback_and_cancel(node: GradedNode, goal: GradedGoal) -> None:
    """A running goal says how far it is, and can be cancelled."""
    goal.accepted_by()
    if not node.context.wait_until(lambda: bool(goal.feedback), 3.0):
        raise Failed(Evidence(goal.shown, "feedback", "none within 3 s"), "No feedback says how far it is.")
    goal.cancelled().ends("CANCELED")


def expect_robot_at(node: GradedNode, x: float, y: float, near: float) -> None:
    """The robot is there within six seconds, give or take near metres; one that rests elsewhere is not waited for."""
    messages = node.inbox("/position").messages

    def is_there(here: Message) -> bool:
        return math.dist((here.x, here.y), (x, y)) <= near

    def rests() -> bool:
        return list(messages)[-_AT_REST:] == _AT_REST * [messages[-1]]

    node.context.wait_until(lambda: bool(messages) and (is_there(messages[-1]) or rests()), 6.0)
    expect_soon(node, "/position", is_there, f"x={x:g}, y={y:g}, give or take {near:g} m", 0.0)


@step("00_welcome", POSITION)
def drive(node: GradedNode) -> None:
    """The robot is near x = 2, y = 1."""
    expect_robot_at(node, 2.0, 1.0, near=0.5)


@step("00_welcome", f"subscription /distance {FLOAT}", "publisher /too_close std_msgs/msg/Bool")
def bumper(node: GradedNode) -> None:
    """/too_close is true for a distance below 0.5, and false for any other."""
    for metres in (0.2, 3.0, 0.5):
        node.send("/distance", metres).expect("/too_close", metres < 0.5)  # noqa: PLR2004 - as the lesson says


@step("00_welcome", f"publisher /ticks {FLOAT}", "node /clock")
def clock(node: GradedNode) -> None:
    """/clock publishes 1.0 on /ticks, twice a second."""
    node.expect("/ticks", 1.0)
    expect_rate(node, "/ticks", 0.5, (0.42, 0.6))


@step("01_services", f"service /subtract_two_ints {ADD}")
def subtract(node: GradedNode) -> None:
    """/subtract_two_ints answers with a - b."""
    node.call("/subtract_two_ints", a=5, b=3).expect(sum=2)
    node.call("/subtract_two_ints", a=3, b=5).expect(sum=-2)
    offers = node.context.grader_node.offers
    if not node.context.wait_until(lambda: "/add_two_ints" in dict(offers("service")), 2.0):
        why = "It subtracts, but minimal_service is gone: a node with its name, or its class's, has replaced it."
        raise Failed(Evidence(), f"{why} Choose other names, and run the cell of MinimalService again.")


@step("01_services", f"service /person_info {PERSON}")
def greet(node: GradedNode) -> None:
    """/person_info answers, because greet returns its response."""
    node.call("/person_info", name="Ada", age=36).expect(success=True)


@step("01_services", f"service /person_info {PERSON}")
def too_old(node: GradedNode) -> None:
    """The receptionist refuses an age above 150 and says why."""
    node.call("/person_info", name="Methuselah", age=969).refused()
    node.call("/person_info", name="Ada", age=-1).refused()
    node.call("/person_info", name="Ada", age=150).expect(success=True)


@step("01_services", "node /demo_robot", MOVE, POSITION, f"service /where {TRIGGER}")
def where(node: GradedNode) -> None:
    """/where says where the robot is, also when it has moved."""
    for x in (0.5, 1.0):
        node.goal("/move_robot", target={"x": x, "y": 0.0}).accepted_by().ends()
        expect_robot_at(node, x, 0.0, near=0.01)
        node.expect("/position")  # so that the one before has come to everybody
        why = f"The robot is at x={x}, y=0.0, and the message does not say so."
        node.call("/where").expect(success=True).expect(message=re.compile(re.escape(f"{x}")).search, why=why)


@step("02_actions", f"action /forgetful {FIBONACCI}")
def succeed(node: GradedNode) -> None:
    """A goal of /forgetful ends SUCCEEDED, with its result."""
    node.goal("/forgetful", order=3).accepted_by().ends(sequence=[0, 1, 1, 2])


@step("02_actions", f"action /sequence {FIBONACCI}")
def short_orders(node: GradedNode) -> None:
    """/sequence accepts orders from 1 to 20, and rejects all others."""
    for order in (21, 0, -5):
        node.goal("/sequence", order=order).rejected(what=f"an order of {order}")
    node.goal("/sequence", order=1).accepted_by().ends()
    node.goal("/sequence", order=20).accepted_by()


@step("02_actions", POSITION)
def corner(node: GradedNode) -> None:
    """The robot is at x = 1, y = 2."""
    expect_robot_at(node, 1.0, 2.0, near=0.05)


@step("02_actions", f"action /countdown {FIBONACCI}")
def countdown(node: GradedNode) -> None:
    """/countdown counts down to 0, and rejects an order below 0."""
    node.goal("/countdown", order=3).accepted_by().ends(sequence=[3, 2, 1, 0])
    node.goal("/countdown", order=0).accepted_by().ends(sequence=[0])
    node.goal("/countdown", order=-1).rejected(what="a negative order")


@step("03_parameters", "node /radio")
def radio(node: GradedNode) -> None:
    """Frequency takes values from 87.5 to 108.0, and no others."""
    node.set(frequency=101.0, of="/radio").accepted()
    node.set(frequency=87.0, of="/radio").refused()
    node.set(frequency=109.0, of="/radio").refused()


@step("03_parameters", "node /greeter", "publisher /greeting std_msgs/msg/String")
def greeter(node: GradedNode) -> None:
    """/greeting says the word five times a second, and a change of it takes effect."""
    expect_rate(node, "/greeting", 0.2, (0.16, 0.26))
    for word in ("moin", "ciao"):
        node.set(word=word, of="/greeter").accepted()
        expect_soon(node, "/greeting", lambda last, word=word: last.data == word, repr(word), 2.0)  # type: ignore[misc]


@step("03_parameters", "node /kettle")
def kettle(node: GradedNode) -> None:
    """Target is refused above 100.0, because water boils there."""
    node.set(target=100.0, of="/kettle").accepted()
    expect_reason(node.set(target=101.0, of="/kettle"), "boil")  # which no range says


@step("03_parameters", "node /lamp")
def lamp(node: GradedNode) -> None:
    """Brightness takes 0 to 100, but not 13, which brings bad luck."""
    node.set(brightness=100, of="/lamp").accepted()
    node.set(brightness=101, of="/lamp").refused()
    node.set(brightness=-1, of="/lamp").refused()
    expect_reason(node.set(brightness=13, of="/lamp"), "luck")


@step("04_choosing_a_pattern", f"action /unload {FIBONACCI}")
def unload(node: GradedNode) -> None:
    """An action: /unload says how far it is, and stops when it is cancelled."""
    expect_feedback_and_cancel(node, node.goal("/unload", order=100))


@step("04_choosing_a_pattern", f"publisher /odometer {FLOAT}")
def odometer(node: GradedNode) -> None:
    """A topic: /odometer tells the metres by itself, five times a second."""
    node.expect("/odometer")
    expect_rate(node, "/odometer", 0.2, (0.16, 0.26))


@step("04_choosing_a_pattern", "node /conveyor")
def belt(node: GradedNode) -> None:
    """A parameter: belt_speed can be read and changed."""
    node.set(belt_speed=0.3, of="/conveyor").accepted()


@step("04_choosing_a_pattern", f"service /honk {TRIGGER}")
def honk(node: GradedNode) -> None:
    """A service: /honk answers whether it worked."""
    node.call("/honk").expect(success=True)


@step("05_command_line", POSITION)
def home(node: GradedNode) -> None:
    """The robot is at x = 1, y = 1."""
    expect_robot_at(node, 1.0, 1.0, near=0.05)


@step("05_command_line", "node /robot")
def quick(node: GradedNode) -> None:
    """The speed limit of /robot is 2.5 m/s."""
    limit = node.get("max_velocity", of="/robot")["max_velocity"]
    if limit != 2.5:  # noqa: PLR2004 - as the lesson says
        raise Failed(Evidence("get max_velocity", "2.5", repr(limit)), f"max_velocity is {limit!r}; it has to be 2.5.")


@step("05_command_line", f"service /sum {ADD}", "node /second")
def second(node: GradedNode) -> None:
    """The node second adds numbers as /sum."""
    node.call("/sum", a=20, b=22).expect(sum=42)


@step("05_command_line", "node /visitor")
def riddle(node: GradedNode) -> None:
    """The visitor has its word back."""
    if not node.get("word", of="/visitor")["word"]:  # the visitor takes no other word than the right one
        raise Failed(Evidence("get word", "the word of its answer", "an empty one"), "The visitor has no word yet.")


@step("06_best_practices", f"service /close_gripper {TRIGGER}")
def close(node: GradedNode) -> None:
    """/close_gripper succeeds, and says what was done."""
    node.call("/close_gripper").expect(success=True).expect(
        message=bool, why="The message is empty: say what was done."
    )


@step("06_best_practices", f"action /rest {FIBONACCI}")
def rest(node: GradedNode) -> None:
    """/rest reports each step, and stops when it is cancelled."""
    node.goal("/rest", order=3).accepted_by().ends(sequence=[0, 1, 2])
    expect_feedback_and_cancel(node, node.goal("/rest", order=30))


@step("06_best_practices", f"service /measure {TRIGGER}")
def measure(node: GradedNode) -> None:
    """/measure answers although its sensor fails, and says why."""
    node.call("/measure").refused(what="to measure without an echo")


@step("06_best_practices", "node /guarded")
def robot_name(node: GradedNode) -> None:
    """robot_name takes a name, and refuses an empty one."""
    node.set(robot_name="Ada", of="/guarded").accepted()
    node.set(robot_name="", of="/guarded").refused()

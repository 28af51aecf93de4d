"""Panels: things in a notebook that show and poke live nodes, made of ipywidgets and anywidget.

Every panel is a `Panel`: displayed as a widget where there is one, described in words everywhere else. A panel shown
again for the same thing replaces the one before; panels end with the lab.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rclpy.node import Node

    from course_kit.panels.arena_map import RobotMap
    from course_kit.panels.corridor import CorridorPicture
    from course_kit.panels.form_view import ServiceForm
    from course_kit.panels.goal_panel import ActionPanel
    from course_kit.panels.graph_view import GraphView
    from course_kit.panels.guess_panel import GuessPanel
    from course_kit.panels.plotting import Comparison, Plot
    from course_kit.panels.quiz_panel import QuizPanel
    from course_kit.panels.sliders import ParameterSliders
    from course_kit.ros.messages import ActionType, Message, ServiceType

# A panel's module is never called like its function: importing it would put the module in the function's place.
__all__ = [
    "action_panel",
    "arena",
    "check_yourself",
    "compare",
    "graph",
    "guess",
    "parameter_sliders",
    "plot",
    "quiz",
    "robot_map",
    "service_form",
]


def service_form(service: str, service_type: ServiceType, *, timeout: float = 5.0) -> ServiceForm:
    """A form that calls a service: a place for each field of the request, then the response or what went wrong.

    Args:
        service: the service's name, such as "/add_two_ints".
        service_type: its class; any service type, the learner's own too.
        timeout: seconds in which the answer must come.

    Raises:
        FieldError: `service_type` is not a service's class.
    """
    from course_kit.panels.form_view import ServiceForm

    return ServiceForm(service, service_type, timeout)


def graph() -> GraphView:
    """A live picture of the ROS graph: nodes, and the services, actions and topics they offer and use."""
    from course_kit.panels.graph_view import GraphView

    return GraphView()


def action_panel(action: str, action_type: ActionType) -> ActionPanel:
    """A form that sends goals: a place for each field of the goal, a progress bar, feedback, Cancel, the result.

    Args:
        action: the action's name, such as "/fibonacci".
        action_type: its class; any action type, the learner's own too.

    Raises:
        FieldError: `action_type` is not an action's class.
    """
    from course_kit.panels.goal_panel import ActionPanel

    return ActionPanel(action, action_type)


def robot_map(action: str = "/move_robot") -> RobotMap:
    """A map of the 10 m x 10 m arena: a click sends `course_interfaces/action/MoveRobot` goals, feedback draws.

    Args:
        action: the action's name.
    """
    from course_kit.panels.arena_map import RobotMap

    return RobotMap(action)


def arena() -> CorridorPicture:
    """The robot of `delivery_robot` on its way, drawn by what its nodes publish.

    Rooms are those of the node /carrier's parameters; positions, in metres, follow /docked and the feedback of goals.
    """
    from course_kit.panels.corridor import CorridorPicture

    return CorridorPicture()


def compare(title: str, values: Mapping[str, float], unit: str) -> Comparison:
    """Measured numbers as bars: `panels.compare("How long it took", {"topic": 81.0, "service": 1.2}, "ms")`.

    Args:
        title: what was measured.
        values: the numbers by what they belong to; finite, none below zero.
        unit: of the numbers.

    Raises:
        ValueError: there is no number, or one that cannot be drawn.
    """
    from course_kit.panels.plotting import Comparison

    return Comparison(title, values, unit)


def parameter_sliders(node: str | Node) -> ParameterSliders:
    """Sliders, boxes and texts that set the parameters of a node, made from its own descriptors.

    Args:
        node: the node's name, such as "/parameter_node", or a node of the lab.

    Raises:
        NodeNotFoundError: no such node has parameters.
    """
    from course_kit.panels.sliders import ParameterSliders

    return ParameterSliders(node)


def plot(topic: str, message_type: type[Message], field: str, *, seconds: float = 20.0) -> Plot:
    """A number of a topic against time, drawn while it arrives: `panels.plot("/cmd_vel", Twist, "linear.x")`.

    Args:
        topic: the topic's name.
        message_type: its type.
        field: which number of a message, such as "data", "linear.x" or "ranges[0]".
        seconds: how many of the last seconds are shown.

    Raises:
        FieldError: there is no such field, or it is no number.
    """
    from course_kit.panels.plotting import Plot

    return Plot(topic, message_type, field, seconds)


def guess(name: str) -> GuessPanel:
    """A question of a lesson before its cell is run: choose, and see what is right and why.

    Args:
        name: the lesson and the question, such as "01_services/late_display".

    Raises:
        NoSuchQuestionError: there is no such question.
    """
    from course_kit.panels.guess_panel import GuessPanel
    from course_kit.quiz import guesses

    return GuessPanel([guesses.find_question(name)])


def check_yourself(lesson: str) -> GuessPanel:
    """The questions at a lesson's end.

    Args:
        lesson: its name, such as "01_services".

    Raises:
        NoSuchQuestionError: there are none for it.
    """
    from course_kit.panels.guess_panel import GuessPanel
    from course_kit.quiz import guesses

    return GuessPanel(guesses.check_questions(lesson))


def quiz(seed: int = 1) -> QuizPanel:
    """The quiz of exercise 4: ten robot scenarios, marked as the grader marks them.

    Args:
        seed: the number your instructor gave you; without one, leave it out.

    Raises:
        TypeError: the seed is no whole number.
    """
    from course_kit.panels.quiz_panel import QuizPanel

    return QuizPanel(seed)

"""Panels: things in a notebook that show and poke live nodes, made of ipywidgets and anywidget.

Every panel is a `Panel`: displayed as a widget where there is one, described in words everywhere else. A panel shown
again for the same thing replaces the one before; panels end with the lab.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from course_kit.panels.plotting import Plot
    from course_kit.panels.quiz_panel import QuizPanel
    from course_kit.panels.sliders import ParameterSliders

__all__ = ["parameter_sliders", "plot", "quiz"]

# A panel's module is never called like its function: importing it would put the module in the function's place.


def parameter_sliders(node: Any) -> ParameterSliders:
    """Sliders, boxes and texts that set the parameters of a node, made from its own descriptors.

    Args:
        node: the node's name, such as "/parameter_node", or a node of the lab.

    Raises:
        NodeNotFoundError: no such node has parameters.
    """
    from course_kit.panels.sliders import ParameterSliders

    return ParameterSliders(node)


def plot(topic: str, message_type: Any, field: str, *, seconds: float = 20.0) -> Plot:
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


def quiz(seed: int = 1) -> QuizPanel:
    """The quiz of exercise 4: ten robot scenarios, marked as the grader marks them.

    Args:
        seed: the number your instructor gave you; without one, leave it out.

    Raises:
        TypeError: the seed is no whole number.
    """
    from course_kit.panels.quiz_panel import QuizPanel

    return QuizPanel(seed)

"""Panels: things in a notebook that show and poke live nodes, made of ipywidgets and anywidget.

Every panel is a `Panel`: displayed as a widget where there is one, described in words everywhere else. A panel shown
again for the same thing replaces the one before; panels end with the lab.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from course_kit.panels.quiz_panel import QuizPanel

# A panel's module is never called like its function: importing it would put the module in the function's place.


def quiz(seed: int = 1) -> QuizPanel:
    """The quiz of exercise 4: ten robot scenarios, marked as the grader marks them.

    Args:
        seed: the number your instructor gave you; without one, leave it out.

    Raises:
        TypeError: the seed is no whole number.
    """
    from course_kit.panels.quiz_panel import QuizPanel

    return QuizPanel(seed)

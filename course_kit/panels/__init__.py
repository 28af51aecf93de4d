"""Panels: things in a notebook that show and poke live nodes, made of ipywidgets and anywidget.

Every panel is a `Panel`: displayed as a widget where there is one, described in words everywhere else. A panel shown
again for the same thing replaces the one before; panels end with the lab.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from course_kit.panels.comparison import Comparison
    from course_kit.panels.quiz_panel import QuizPanel

# A panel's module is never called like its function: importing it would put the module in the function's place.


def compare(title: str, values: Mapping[str, float], unit: str) -> Comparison:
    """Measured numbers as bars: `panels.compare("How long it took", {"topic": 81.0, "service": 1.2}, "ms")`.

    Args:
        title: what was measured.
        values: the numbers by what they belong to; finite, none below zero.
        unit: of the numbers.

    Raises:
        ValueError: there is no number, or one that cannot be drawn.
    """
    from course_kit.panels.comparison import Comparison

    return Comparison(title, values, unit)


def quiz(seed: int = 1) -> QuizPanel:
    """The quiz of exercise 4: ten robot scenarios, marked as the grader marks them.

    Args:
        seed: the number your instructor gave you; without one, leave it out.

    Raises:
        TypeError: the seed is no whole number.
    """
    from course_kit.panels.quiz_panel import QuizPanel

    return QuizPanel(seed)

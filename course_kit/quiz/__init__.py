"""The quiz on communication patterns: its scenarios, who gets which, what an answer earns, and how they are shown.

The exercise's grader and the notebook's panel both use it: `draw_scenarios` by a seed, `mark` the answers to them.
It needs no ROS. A learner calls `show()`.
"""

from course_kit.quiz.bank import (
    DEFAULT_SEED,
    PATTERNS,
    Scenario,
    bank,
    draw_scenarios,
    graded_scenarios,
    practice_scenarios,
    reasons_as_shown,
)
from course_kit.quiz.marking import PASS_SHARE, HalfMarks, MarkedAnswers, Marks, NoAnswer, mark, mark_one, nearest_id
from course_kit.quiz.showing import Questions, show

__all__ = [
    "DEFAULT_SEED",
    "PASS_SHARE",
    "PATTERNS",
    "HalfMarks",
    "MarkedAnswers",
    "Marks",
    "NoAnswer",
    "Questions",
    "Scenario",
    "bank",
    "draw_scenarios",
    "graded_scenarios",
    "mark",
    "mark_one",
    "nearest_id",
    "practice_scenarios",
    "reasons_as_shown",
    "show",
]

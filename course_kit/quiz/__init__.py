"""The quiz on communication patterns: its scenarios, who gets which, what an answer earns, and how they are shown.

The exercise's grader and the notebook's panel both use it: `draw` the scenarios of a seed, `mark` the answers to them.
It needs no ROS. A learner calls `show()`.
"""

from course_kit.quiz.bank import DEFAULT_SEED, PATTERNS, Questions, Scenario, bank, reasons_as_shown, show
from course_kit.quiz.bank import draw_scenarios as draw
from course_kit.quiz.bank import graded_scenarios as graded
from course_kit.quiz.bank import practice_scenarios as practice
from course_kit.quiz.marking import PASS_SHARE, MarkedAnswers, Marks, mark, mark_one, read_answers
from course_kit.quiz.marking import HalfMarks as Half
from course_kit.quiz.marking import NoAnswer as Unusable
from course_kit.quiz.marking import nearest_id as nearest

__all__ = [
    "DEFAULT_SEED",
    "PASS_SHARE",
    "PATTERNS",
    "Half",
    "MarkedAnswers",
    "Marks",
    "Questions",
    "Scenario",
    "Unusable",
    "bank",
    "draw",
    "graded",
    "mark",
    "mark_one",
    "nearest",
    "practice",
    "read_answers",
    "reasons_as_shown",
    "show",
]

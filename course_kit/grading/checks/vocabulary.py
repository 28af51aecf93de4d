"""All that a file of checks imports: `from course_kit.grading.checks.vocabulary import check, conversation, ...`."""

from __future__ import annotations

from course_kit.grading.checks.answers import Answer, Change
from course_kit.grading.checks.check import Check, Evidence, Failed
from course_kit.grading.checks.conversation import Model, conversation, part
from course_kit.grading.checks.drawing import between, drawn, either
from course_kit.grading.checks.graded_goal import GradedGoal
from course_kit.grading.checks.graded_node import GradedNode
from course_kit.grading.checks.matching import close
from course_kit.grading.checks.ready_made import (
    check,
    node_name,
    offered,
    service_answers,
    service_refuses,
    topic_answers,
    topic_rate,
    topic_silent,
)
from course_kit.grading.checks.ready_made_goals import goal_cancelled, goal_feedback, goal_refused, goal_succeeds
from course_kit.grading.checks.ready_made_parameters import parameter_acts, parameter_declared, parameter_refuses
from course_kit.grading.checks.steps import rule

__all__ = [
    "Answer",
    "Change",
    "Check",
    "Evidence",
    "Failed",
    "GradedGoal",
    "GradedNode",
    "Model",
    "between",
    "check",
    "close",
    "conversation",
    "drawn",
    "either",
    "goal_cancelled",
    "goal_feedback",
    "goal_refused",
    "goal_succeeds",
    "node_name",
    "offered",
    "parameter_acts",
    "parameter_declared",
    "parameter_refuses",
    "part",
    "rule",
    "service_answers",
    "service_refuses",
    "topic_answers",
    "topic_rate",
    "topic_silent",
]

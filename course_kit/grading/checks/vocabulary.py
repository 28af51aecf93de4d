"""All that a file of checks imports: `from course_kit.grading.checks.vocabulary import check, conversation, ...`."""

from __future__ import annotations

from course_kit.grading.checks.answers import Answer, Approximation, Change
from course_kit.grading.checks.check import Check
from course_kit.grading.checks.conversation import CheckPart, Model, conversation
from course_kit.grading.checks.evidence import Evidence, Failed
from course_kit.grading.checks.graded_goal import GradedGoal
from course_kit.grading.checks.graded_node import GradedNode, offer_service
from course_kit.grading.checks.ready_made import (
    check,
    endpoints_offered,
    node_name,
    parameter_acts,
    parameter_declared,
    parameter_refuses,
    service_answers,
    service_refuses,
    topic_answers,
    topic_rate,
    topic_silent,
)
from course_kit.grading.checks.ready_made_goals import goal_cancelled, goal_feedback, goal_refused, goal_succeeds
from course_kit.grading.checks.steps import draw_between, draw_by, draw_one_of, step_rule

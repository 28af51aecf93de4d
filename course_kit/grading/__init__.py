"""Grading: a submission in its cage, a grader that asks it over the wire, and a report written by us alone."""

from course_kit.grading.engine import grade
from course_kit.grading.errors import GradingError
from course_kit.grading.report import CheckReport, Report, exit_code
from course_kit.grading.worker import Worker

__all__ = ["CheckReport", "GradingError", "Report", "Worker", "exit_code", "grade"]

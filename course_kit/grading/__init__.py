"""Grading: a submission in its sandbox, a grader that asks it over ROS, and a report written by us alone.

Commands and magics need these: `grade` for a `Report`, `exit_code`, `render_text`, `render_html`, `GradingError` for
what to tell the user; `Worker` to grade many; `isolation_status` for the doctor.
"""

from course_kit.grading.engine import grade
from course_kit.grading.errors import GradingError
from course_kit.grading.model.report import CheckReport, Report, exit_code
from course_kit.grading.render.html import render_html
from course_kit.grading.render.text import render_text
from course_kit.grading.sandbox.isolation import advice_for_root
from course_kit.grading.workers.worker import Worker, isolation_status

__all__ = [
    "CheckReport",
    "GradingError",
    "Report",
    "Worker",
    "advice_for_root",
    "exit_code",
    "grade",
    "isolation_status",
    "render_html",
    "render_text",
]

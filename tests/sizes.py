"""Which tests the usual run leaves to `./course test --all`, and which ones a quick run leaves out, too.

The beginning of a test's id is enough. CONTRIBUTING says which usual test notices what a weekly one is there for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

WEEKLY = (
    "tests/browser/test_class_page.py::test_three_hundred_students_on_a_page_that_anybody_can_read[1400-",
    "tests/browser/test_class_page.py::test_three_hundred_students_on_a_page_that_anybody_can_read[400-light]",
    "tests/classroom/test_interrupted_runs.py::test_killed_at_twenty_random_moments",
    "tests/classroom/test_killed_roles.py",
    "tests/cli/test_locale.py::test_the_commands_work_in_a_folder_with_an_umlaut",
    "tests/grading/checks/test_fairness.py::test_starving_itself_buys_a_slow_program_no_patience[with",
    "tests/grading/checks/test_sending_attacks.py::test_writing_without_end",
    "tests/grading/checks/test_sending_attacks.py::test_service_answers_of_8_mb[not",
    "tests/grading/checks/test_sending_attacks.py::test_long_names_and_reasons",
    "tests/grading/checks/test_sending_attacks.py::test_action_results_of_8_mb",
    "tests/grading/checks/test_sending_attacks.py::test_a_status_line_costs_the_points_for_the_status",
    "tests/grading/sandbox/test_trusted_path.py::test_class_loads_nothing_from_the_folder_it_grades[script]",
    "tests/grading/test_reading_attacks.py::test_the_rest_of_a_class_is_graded",
    "tests/interfaces/test_reference_build.py",
    "tests/test_wheel.py",
)
# More than some seconds each: whole classes, set-ups, editions, kernels, attacks, and all submissions.
SLOW = (
    "tests/authoring/prove/",
    "tests/authoring/test_carried_exercises.py",
    "tests/authoring/test_check.py",
    "tests/authoring/test_new_exercise.py",
    "tests/authoring/test_leaks.py",
    "tests/authoring/test_release.py",
    "tests/classroom/test_class_command.py",
    "tests/classroom/test_hostile_intake.py",
    "tests/classroom/test_intake_fuzz.py",
    "tests/classroom/test_interrupted_runs.py",
    "tests/classroom/test_nbgrader.py",
    "tests/classroom/test_otter.py",
    "tests/classroom/test_outside_exercise.py",
    "tests/classroom/test_regrade.py",
    "tests/classroom/test_roster.py",
    "tests/classroom/test_system_inboxes.py",
    "tests/cli/",
    "tests/course_setup/",
    "tests/dev/",
    "tests/graders/robot_parameters/test_starts.py",
    "tests/graders/test_move_robot.py",
    "tests/graders/test_strange_answers.py",
    "tests/grading/checks/test_deadlines.py",
    "tests/grading/checks/test_fairness.py",
    "tests/grading/checks/test_sending_attacks.py",
    "tests/grading/sandbox/",
    "tests/grading/test_exchange_log.py",
    "tests/grading/test_linear.py",
    "tests/grading/test_needs.py",
    "tests/grading/test_reader.py",
    "tests/grading/test_reading_attacks.py",
    "tests/grading/workers/",
    "tests/integrations/test_submission_cells.py",
    "tests/integrations/test_terminals.py",
    "tests/lab/test_notebook.py",
    "tests/lab/test_other_notebooks.py",
    "tests/lab/test_scripts.py",
    "tests/lab/test_usual_mistakes.py",
    "tests/learner/",
    "tests/notebooks/test_demos.py",
    "tests/presentation/",
    "tests/proof/",
    "tests/ros/test_compat.py",
    "tests/ros2cli/test_errors.py",
    "tests/ros2cli/test_graph.py",
    "tests/ros2cli/test_launch.py",
    "tests/ros2cli/test_lesson_programs.py",
    "tests/ros2cli/test_recordings.py",
    "tests/ros2cli/test_tutorials.py",
    "tests/test_code_style.py::test_mypy",
)


def marks_of(test: str) -> Iterator[pytest.MarkDecorator]:
    """The marks of a test, by its id."""
    if test.startswith(WEEKLY):
        yield pytest.mark.weekly
    if test.startswith(SLOW):
        yield pytest.mark.slow

"""Which tests the usual run leaves to `./course test --all`, and which ones a quick run leaves out, too.

The beginning of a test's id is enough. Above weekly ones: what was broken on purpose, and which usual test noticed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

WEEKLY = (
    # The made proof set lacked its wrong program: the other kinds in authoring/test_new_exercise.py.
    "tests/authoring/test_new_exercise.py::test_what_is_made_is_proven_by_its_own_set[parameters]",
    "tests/authoring/test_new_exercise.py::test_what_is_made_is_proven_by_its_own_set[topic]",
    # The score of a program was not compared: authoring/test_leaks.py, test_carried_exercises.py.
    "tests/authoring/test_release.py::test_no_program_in_it_scores",
    # Dark ink was as dark as its paper: browser/test_class_page.py at 400 pixels in the dark.
    "tests/browser/test_class_page.py::test_three_hundred_students_on_a_page_that_anybody_can_read[1400-light]",
    "tests/browser/test_class_page.py::test_what_it_leads_to_can_be_read_by_anybody_too[comparison-1400-light]",
    "tests/browser/test_class_page.py::test_what_it_leads_to_can_be_read_by_anybody_too[report-1400-light]",
    # The page did not scroll to the heading: browser/test_report_card.py in JupyterLab.
    "tests/browser/test_mistakes_and_neighbours.py::test_a_link_lands_at_its_heading_at_the_first_click_in_notebook_7",
    # A record was cut short, a page without a record stayed: classroom/test_resume.py.
    "tests/classroom/test_interrupted_runs.py::test_killed_at_twenty_random_moments",
    # A worker that died was not tried again: classroom/test_class_command.py.
    "tests/classroom/test_killed_roles.py",
    "tests/graders/test_move_robot.py::test_attach_grades_a_robot",
    # What starving programs compute counted as lost: grading/checks/test_fair_clock.py.
    "tests/grading/checks/test_fairness.py",
    # Texts of messages were not cut: grading/test_bounds.py.
    "tests/grading/checks/test_sending_attacks.py::test_writing_without_end",
    "tests/grading/checks/test_sending_attacks.py::test_service_answers_of_8_mb",
    "tests/grading/checks/test_sending_attacks.py::test_long_names_and_reasons",
    "tests/grading/checks/test_sending_attacks.py::test_action_results_of_8_mb",
    "tests/grading/checks/test_sending_attacks.py::test_feedback_without_end",
    "tests/grading/checks/test_sending_attacks.py::test_a_status_line_that_is_no_text",
    "tests/grading/sandbox/test_hostile.py::test_a_flood_of_notes",
    # The reader could take all memory: each file of grading/test_reading_attacks.py.
    "tests/grading/test_reading_attacks.py::test_the_rest_of_a_class_is_graded",
    "tests/presentation/test_present_command.py::test_two_at_a_time",
    # The wheel lacked style sheets: test_hatch_build.py.
    "tests/test_wheel.py",
)
# The folders with the files that compute the longest, and the file with mypy. Those of each are spread over the first
# part of a run, among those that mostly wait for nodes: the processors are busy to the end, and never have many
# browsers at once.
LONG = (
    "tests/proof/",
    "tests/browser/",
    "notebooks/",
    "tests/classroom/",
    "tests/authoring/",
    "tests/dev/",
    "tests/presentation/",
    "tests/course_setup/",
    "tests/test_code_style.py",
)
FIRST_PART = 0.7  # of a run
# More than some seconds each: whole classes, set-ups, editions, kernels, attacks, and all submissions.
SLOW = (
    "tests/authoring/",
    "tests/classroom/exports/test_autograders.py::test_gradescope_and_classroom_50_grade_a_folder_and_end_with_0",
    "tests/classroom/test_class_command.py",
    "tests/classroom/test_hostile_intake.py",
    "tests/classroom/test_intake.py",
    "tests/classroom/test_interrupted_runs.py",
    "tests/classroom/test_nbgrader.py",
    "tests/classroom/test_otter.py",
    "tests/classroom/test_outside_exercise.py",
    "tests/classroom/test_regrade.py",
    "tests/classroom/test_resume.py",
    "tests/classroom/test_roster.py",
    "tests/classroom/test_run.py",
    "tests/classroom/test_versions.py",
    "tests/cli/",
    "tests/course_setup/",
    "tests/dev/",
    "tests/graders/robot_parameters/test_starts.py",
    "tests/graders/test_move_robot.py",
    "tests/graders/test_strange_answers.py",
    "tests/grading/checks/test_deadlines.py",
    "tests/grading/checks/test_sending_attacks.py",
    "tests/grading/sandbox/",
    "tests/grading/test_engine.py",
    "tests/grading/checks/test_evidence.py",
    "tests/grading/test_first_failure.py",
    "tests/grading/test_linear.py",
    "tests/grading/test_needs.py",
    "tests/grading/test_outside_exercise.py",
    "tests/grading/test_reader.py",
    "tests/grading/test_reading_attacks.py",
    "tests/grading/workers/",
    "tests/integrations/test_export.py",
    "tests/integrations/test_jupyter.py",
    "tests/integrations/test_outside_exercise.py",
    "tests/integrations/test_submission_cells.py",
    "tests/integrations/test_terminals.py",
    "tests/interfaces/test_field_checks.py",
    "tests/lab/test_demo_graphs.py",
    "tests/lab/test_notebook.py",
    "tests/lab/test_other_notebooks.py",
    "tests/lab/test_programs_in_cells.py",
    "tests/lab/test_scripts.py",
    "tests/lab/test_usual_mistakes.py",
    "tests/learner/",
    "tests/notebooks/test_demos.py",
    "tests/presentation/",
    "tests/proof/",
    "tests/ros/test_compat.py",
    "tests/ros2cli/test_errors.py",
    "tests/ros2cli/test_graph.py",
    "tests/ros2cli/test_in_a_notebook.py",
    "tests/ros2cli/test_launch.py",
    "tests/ros2cli/test_recordings.py",
    "tests/ros2cli/test_tutorials.py",
    "tests/test_code_style.py::test_mypy",
)


def places(files: Iterable[str]) -> dict[str, float]:
    """When each file begins, from 0 to 1, as a share of the run."""
    kinds: dict[str, list[str]] = {folder: [] for folder in LONG}
    for file in files:
        kinds.setdefault(next((folder for folder in LONG if file.startswith(folder)), ""), []).append(file)
    return {
        file: place / len(found) * (FIRST_PART if folder else 1.0)
        for folder, found in kinds.items()
        for place, file in enumerate(found)
    }


def marks_of(test: str) -> Iterator[pytest.MarkDecorator]:
    """The marks of a test, by its id."""
    if test.startswith(WEEKLY):
        yield pytest.mark.weekly
    if test.startswith(SLOW):
        yield pytest.mark.slow

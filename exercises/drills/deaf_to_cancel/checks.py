"""What has to work in the drill deaf_to_cancel."""

from course_kit.grading.checks.vocabulary import (
    endpoints_offered,
    goal_cancelled,
    goal_feedback,
    goal_succeeds,
)

CHECKS = [
    endpoints_offered(title="The action /count_down is there", points=1.0, proves=["action"]),
    goal_succeeds(
        "/count_down",
        [{"order": 3}, {"order": 5}],
        lambda goal: {"sequence": list(range(goal.order, 0, -1))},
        check_id="counts",
        title="A goal counts down and succeeds",
        points=1.0,
        after=["offered"],
        proves=["counts"],
        not_before_s=0.55,
    ),
    goal_feedback(
        "/count_down",
        [{"order": 4}],
        check_id="feedback",
        title="Each number is published while the goal runs",
        points=1.0,
        after=["counts"],
        proves=["in_steps"],
        at_least=4,
        first=lambda _: {"sequence": [4]},
        last=lambda _: {"sequence": [4, 3, 2, 1]},
    ),
    goal_cancelled(
        "/count_down",
        [{"order": 20}, {"order": 15}],
        check_id="cancel",
        title="A running goal can be cancelled",
        points=1.0,
        after=["counts"],
        proves=["cancel"],
        then={"order": 2},
    ),
]
